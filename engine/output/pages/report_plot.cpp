#include "output/pages/report_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/error.h"
#include "output/files/child_program.h"
#include "output/files/markup.h"
#include "output/files/whole_file.h"
#include "output/pages/report_table.h"

namespace supple {
namespace {

constexpr int width = 900;               // [px]
constexpr int height_of_axes = 515;      // without the legend [px]
constexpr int height_of_row = 25;        // of the legend [px]
constexpr double width_of_letter = 7.3;  // average width of a letter in the legend [px]

// These colours can be told apart by colour-blind eyes: no two share both hue and lightness. The first colours of
// `thick` and `thin` are those of the films.
constexpr std::array thick_colors = {"#d9822b", "#a63603", "#f2b134"};
constexpr std::array thin_colors = {"#4c78a8", "#59a14f", "#222222", "#56b4e9",
                                    "#aa4499", "#999933", "#882255", "#9a9a9a"};
constexpr std::array dashes = {"solid", "(14,4,2,4)", "(3,3)"};
constexpr const char* dash_of_dashed = "(8,5)";
constexpr std::array markers = {7, 5, 9, 11, 13, 6, 4, 8, 10, 12, 15, 2};  // gnuplot's numbers: filled ones first
static_assert(thin_colors.size() * dashes.size() == plot_looks);

struct Look {
  const char* color;
  const char* dash;
  int marker;
  double line_width;
};

std::vector<Look> looks_of(const ReportPlot& plot) {
  std::vector<Look> looks;
  int thick = 0, thin = 0;
  for (const PlotSeries& series : plot.series) {
    Look look{};
    if (series.thick) {
      look = {thick_colors[std::size_t(thick) % thick_colors.size()], "solid", 7, 4};
      ++thick;
    } else {
      const auto place = std::size_t(series.look >= 0 ? series.look : thin) % plot_looks;
      look = {thin_colors[place % thin_colors.size()], dashes[place / thin_colors.size()],
              markers[place % markers.size()], 1.8};
      ++thin;
    }
    if (series.dashed) look.dash = dash_of_dashed;
    looks.push_back(look);
  }
  return looks;
}

// Holds the points of a series that can be drawn.
struct Points {
  std::vector<double> x, y;
};

std::vector<Points> drawn_points(const ReportPlot& plot) {
  const auto fits = [](double value, bool log) { return std::isfinite(value) && (!log || value > 0); };
  std::vector<Points> all;
  for (const PlotSeries& series : plot.series) {
    Points& points = all.emplace_back();
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!fits(series.x[i], plot.log_x) || !fits(series.y[i], plot.log_y)) continue;
      points.x.push_back(series.x[i]);
      points.y.push_back(series.y[i]);
    }
  }
  return all;
}

std::string plot_csv(const ReportPlot& plot) {
  const auto exact = [](double value) { return std::isnan(value) ? std::string() : fmt::format("{}", value); };
  std::vector<std::vector<std::string>> records = {{"series", "x", "y"}};
  for (const PlotSeries& series : plot.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      records.push_back({series.name, exact(series.x[i]), exact(series.y[i])});
  return csv_text(records);
}

// Puts a text between single quotes, where gnuplot neither expands nor unescapes anything. Control characters, which
// have no place in an SVG, become spaces.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 32 || c == 127 ? ' ' : c;
  }
  return result + "'";
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool whole = true;  // whether all values are whole numbers
};

Range range_of(const std::vector<Points>& all, std::vector<double> Points::*values) {
  Range range;
  for (const Points& points : all) {
    for (const double value : points.*values) {
      range = {std::min(range.low, value), std::max(range.high, value), range.whole && value == std::trunc(value)};
    }
  }
  return range;
}

// Places the ticks of a logarithmic axis that shows less than two decades, where gnuplot would label too few.
std::string close_ticks(char axis, double low, double high) {
  const double decades = std::log10(high / low);
  std::vector<double> digits = {1, 2, 5};
  if (decades < 0.8) digits = {1, 1.5, 2, 3, 5, 7};
  if (decades < 0.45) digits = {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8};
  std::string ticks;
  for (int power = int(std::floor(std::log10(low))); power <= int(std::ceil(std::log10(high))); ++power) {
    for (const double digit : digits) {
      const double tick = digit * std::pow(10, power);
      if (tick >= low && tick <= high) ticks += fmt::format("{0}'{1:g}' {1:g}", ticks.empty() ? "" : ", ", tick);
    }
  }
  return fmt::format("set format {0} '%g'\nset m{0}tics 1\nset {0}tics ({1})\n", axis, ticks);
}

std::string linear_axis(char axis, const Range& data, double low, double high) {
  std::string script = fmt::format("set format {} '%g'\n", axis);
  if (low < high) script += fmt::format("set {}range [{}:{}]\n", axis, low, high);
  if (data.whole && data.high - data.low <= 16) script += fmt::format("set {}tics 1\n", axis);
  return script;
}

// Writes the range and ticks of an axis; `low` and `high` are what the plot asks for.
std::string axis_script(char axis, bool log, const Range& data, double low, double high) {
  if (!log) return linear_axis(axis, data, low, high);
  const bool wide = std::log10(data.high) - std::log10(data.low) > 1.5;
  Range shown = data;
  if (wide) {
    shown.low = std::pow(10, std::floor(std::log10(data.low) + 0.05));
    shown.high = std::pow(10, std::ceil(std::log10(data.high) - 0.05));
  }
  const double air = axis == 'x' && wide ? 1 : 1.25;
  shown = {shown.low / air, shown.high * air, data.whole};
  if (low > 0) shown.low = low;
  if (high > shown.low) shown.high = high;
  const double decades = std::log10(shown.high) - std::log10(shown.low);
  if (decades < 0.18) return linear_axis(axis, data, shown.low, shown.high);
  const std::string script = fmt::format("set logscale {0}\nset {0}range [{1}:{2}]\n", axis, shown.low, shown.high);
  if (decades < 2) return script + close_ticks(axis, shown.low, shown.high);
  const double step = std::pow(10, std::ceil(decades / 12));
  return script + fmt::format("set format {0} '10^{{%L}}'\nset {0}tics {1}\nset m{0}tics {2}\n", axis, step,
                              step == 10 ? 10 : 1);
}

int legend_columns(const ReportPlot& plot) {
  std::size_t longest = 1;
  for (const PlotSeries& series : plot.series) longest = std::max(longest, count_code_points(series.name));
  return std::max(1, int((width - 60) / (60 + width_of_letter * double(longest))));
}

std::string frame_script(const ReportPlot& plot, const std::vector<Points>& points) {
  const auto named =
      std::count_if(plot.series.begin(), plot.series.end(), [](const auto& s) { return !s.name.empty(); });
  const int columns = legend_columns(plot);
  const int rows = (int(named) + columns - 1) / columns;
  std::string script = fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {},{} enhanced font 'sans-serif,15' background '#ffffff' linewidth 1\n"
      "set border 3 linecolor '#666666'\n"
      "set tics nomirror textcolor '#333333'\n"
      "set grid xtics ytics linecolor '#e3e3e3' linewidth 1, linecolor '#f0f0f0'\n"
      "set key outside below center horizontal Left reverse noenhanced samplen 3 spacing 1.2 height 0.7 maxcols {} "
      "font ',14' textcolor '#222222'\n"
      "set rmargin 4\n"
      "set xlabel {} offset 0,0.7 noenhanced textcolor '#222222'\n"
      "set ylabel {} offset 0.5,0 noenhanced textcolor '#222222'\n",
      width, height_of_axes + rows * height_of_row, columns, quoted(plot.x_label), quoted(plot.y_label));
  script += axis_script('x', plot.log_x, range_of(points, &Points::x), plot.x_min, plot.x_max);
  script += axis_script('y', plot.log_y, range_of(points, &Points::y), plot.y_min, plot.y_max);
  return script;
}

std::string style_script(ReportPlot::Style style, const Look& look, std::size_t count) {
  const std::string line =
      fmt::format("linecolor '{}' linewidth {} dashtype {}", look.color, look.line_width, look.dash);
  const std::string marker = fmt::format("pointtype {}", look.marker);
  if (style == ReportPlot::Style::points)
    return fmt::format("with points linecolor '{}' {} pointsize {}", look.color, marker,
                       look.line_width > 2 ? 1.1 : 0.8);
  if (style == ReportPlot::Style::steps) return "with steps " + line;
  // A curve of few points has a marker on each; a curve of many has about eight, which tell curves apart where colour
  // does not.
  const std::size_t interval = count <= 12 ? 1 : count / 8;
  return fmt::format("with linespoints {} {} pointsize {} pointinterval {}", line, marker,
                     look.line_width > 2 ? 0.8 : 0.6, interval);
}

// Holds gnuplot's script, and the names of the picture's groups in the order of plotting.
struct Script {
  std::string text;
  std::vector<std::string> groups;
};

Script plot_script(const ReportPlot& plot, const std::vector<Points>& points, const std::filesystem::path& picture) {
  const std::vector<Look> looks = looks_of(plot);
  Script script{frame_script(plot, points) + "set output " + quoted(file_word(picture)) + "\n", {}};
  std::string items;
  const auto add = [&](std::size_t i, bool in_legend) {
    const std::string title =
        in_legend && !plot.series[i].name.empty() ? "title " + quoted(plot.series[i].name) : "notitle";
    items += fmt::format("{} $series_{} using 1:2 {} {}", items.empty() ? "plot" : ", \\\n", i,
                         style_script(plot.style, looks[i], points[i].x.size()), title);
    script.groups.push_back(plot.series[i].name);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].x.empty()) continue;
    script.text += fmt::format("$series_{} << END_OF_SERIES\n", i);
    for (std::size_t k = 0; k < points[i].x.size(); ++k)
      script.text += fmt::format("{} {}\n", points[i].x[k], points[i].y[k]);
    script.text += "END_OF_SERIES\n";
    add(i, true);
  }
  // The legend keeps the order of the series, although the thick ones are drawn last, on top.
  for (std::size_t i = 0; i < points.size(); ++i)
    if (plot.series[i].thick && !points[i].x.empty()) add(i, false);
  script.text += items + "\n";
  return script;
}

std::string drawn_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Returns what a program wrote, after a colon, or nothing when it wrote nothing.
std::string after_colon(const std::string& output) {
  const std::size_t first = output.find_first_not_of(" \n"), last = output.find_last_not_of(" \n");
  return first == std::string::npos ? "" : ": " + output.substr(first, last + 1 - first);
}

void replace_first(std::string& text, const std::string& from, const std::string& to) {
  if (const std::size_t at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
}

// Gives the picture ids that no other picture on a page has, and titles for people.
std::string named_svg(const ReportPlot& plot, const std::vector<std::string>& groups, std::string svg) {
  const std::size_t title = svg.find("<title>"), end = svg.find("</desc>");
  if (title == std::string::npos || end == std::string::npos) return "";
  svg.replace(title, end + 7 - title, "<title>" + markup_text(plot.title) + "</title>");
  for (std::size_t i = groups.size(); i > 0; --i)
    replace_first(svg, fmt::format("<title>gnuplot_plot_{}</title>", i),
                  "<title>" + markup_text(groups[i - 1]) + "</title>");
  return with_id_prefix(svg, plot.name + "-");
}

}  // namespace

bool write_plot(const ReportPlot& plot, const std::filesystem::path& folder, std::string* why) {
  check_report_name(plot.name);
  for (const PlotSeries& series : plot.series) SUPPLE_CHECK(series.x.size(), ==, series.y.size());
  write_whole_file(folder / (plot.name + ".csv"), plot_csv(plot));

  const std::filesystem::path svg = folder / (plot.name + ".svg");
  const std::filesystem::path script_file = folder / (plot.name + ".part.gp");
  const std::filesystem::path part = folder / (plot.name + ".part.svg");
  std::error_code ignored;
  std::filesystem::remove(svg, ignored);
  const auto refuse = [&](const std::string& reason) {
    if (why) *why = fmt::format("no picture of {0}: {1}; its numbers are in {0}.csv", plot.name, reason);
    return false;
  };
  const std::vector<Points> points = drawn_points(plot);
  if (std::all_of(points.begin(), points.end(), [](const Points& p) { return p.x.empty(); }))
    return refuse("it has no point that can be drawn");

  const Script script = plot_script(plot, points, part);
  write_whole_file(script_file, script.text);
  const auto drawn = run_program({"gnuplot", "--default-settings", file_word(script_file)});
  const std::string picture = drawn && drawn->status == 0 ? named_svg(plot, script.groups, drawn_text(part)) : "";
  std::filesystem::remove(script_file, ignored);
  std::filesystem::remove(part, ignored);
  if (!drawn) return refuse("gnuplot is not installed (Debian: gnuplot-nox)");
  if (drawn->status != 0) return refuse(fmt::format("gnuplot {}{}", how_it_ended(*drawn), after_colon(drawn->output)));
  if (picture.empty()) return refuse("gnuplot wrote no SVG" + after_colon(drawn->output));
  write_whole_file(svg, picture);
  return true;
}

}  // namespace supple
