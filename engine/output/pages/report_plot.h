// Writes the plots of a report: the numbers as CSV, and the picture as SVG, drawn by the gnuplot program when it is
// installed. Nothing here knows what is plotted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

struct PlotSeries {
  std::string name;                    // name in the legend, which leaves out series with an empty name
  std::vector<double> x = {}, y = {};  // of one length
  bool thick = false;                  // marks what the report is about: orange, wide, above the others
  bool dashed = false;
  // Chooses colour, dash and marker: one of plot_looks, of which the first eight are blue, green, black, sky, purple,
  // olive, wine and grey. With -1 the place among the series decides; on a page, series of one name look alike in all
  // its plots.
  int look = -1;
};
constexpr int plot_looks = 24;

struct ReportPlot {
  std::string name, title = {}, note = {};  // NAME.svg; the title stands below the picture on the page, not in it
  std::string x_label = {}, y_label = {};
  bool log_x = false, log_y = true;
  enum class Style { lines, points, steps } style = Style::lines;
  std::vector<PlotSeries> series = {};                // values <= 0 on a log axis and non-finite ones are left out
  double y_min = 0, y_max = 0, x_min = 0, x_max = 0;  // chosen from the data when both are 0
};

// Always writes folder/NAME.csv (series, x, y, with all digits and all points), and folder/NAME.svg through gnuplot.
// Without gnuplot, or when it fails, the result is false, `why` (may be null) says what to do, and a picture that an
// earlier run left is removed.
bool write_plot(const ReportPlot& plot, const std::filesystem::path& folder, std::string* why);

}  // namespace supple
