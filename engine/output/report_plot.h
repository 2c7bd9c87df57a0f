// Plots of a report: the numbers as CSV, the picture as SVG by the gnuplot program when it is installed. Nothing here
// knows what is plotted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

struct PlotSeries {
  std::string name;                    // in the legend; empty: not in it
  std::vector<double> x = {}, y = {};  // of one length
  bool thick = false;                  // what the report is about: orange, wide, above the others
  bool dashed = false;
  // Colour, dash and marker: one of plot_looks, of which the first eight are blue, green, black, sky, purple, olive,
  // wine and grey. -1: by the place among the series; on a page, series of one name look alike in all its plots.
  int look = -1;
};
constexpr int plot_looks = 24;

struct ReportPlot {
  std::string name, title = {}, note = {};  // NAME.svg; the title stands below the picture on the page, not in it
  std::string x_label = {}, y_label = {};
  bool log_x = false, log_y = true;
  enum class Style { lines, points, steps } style = Style::lines;
  std::vector<PlotSeries> series = {};                // values <= 0 on a log axis and non-finite ones are left out
  double y_min = 0, y_max = 0, x_min = 0, x_max = 0;  // both 0: chosen from the data
};

// folder/NAME.csv (series, x, y, with all digits and all points) always. folder/NAME.svg through gnuplot; without
// gnuplot, or when it fails, the result is false, `why` (may be null) says what to do, and no picture of an earlier run
// stays behind.
bool write_plot(const ReportPlot& plot, const std::filesystem::path& folder, std::string* why);

}  // namespace supple
