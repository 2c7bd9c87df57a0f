#include "output/pages/run_graphs.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "output/files/markup.h"
#include "output/pages/page_parts.h"

namespace supple {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Value = std::function<double(const BodyRow&)>;

FrameSeries by_frame(const std::vector<FrameRow>& rows, std::string name,
                     const std::function<double(const FrameRow&)>& value) {
  FrameSeries series{std::move(name), {}};
  for (const FrameRow& row : rows) series.values.push_back(value(row));
  return series;
}

// Returns a series for each body that has such values.
std::vector<FrameSeries> by_body(const std::vector<FrameRow>& rows, const std::string& suffix, const Value& value) {
  std::vector<FrameSeries> result;
  for (std::size_t b = 0; b < rows.front().bodies.size(); ++b) {
    FrameSeries series =
        by_frame(rows, rows.front().bodies[b].name + suffix, [&](const FrameRow& row) { return value(row.bodies[b]); });
    if (std::ranges::any_of(series.values, [](double v) { return std::isfinite(v); }))
      result.push_back(std::move(series));
  }
  return result;
}

// Returns, for each pair of bodies that touched each other, its row with the greatest depth; the deepest pair comes
// first.
std::vector<PairRow> deepest_of_pairs(const std::vector<FrameRow>& rows) {
  std::vector<PairRow> deepest;
  for (const FrameRow& row : rows) {
    for (const PairRow& pair : row.pairs) {
      const auto known = std::ranges::find(deepest, pair.bodies, &PairRow::bodies);
      if (known == deepest.end()) {
        deepest.push_back(pair);
      } else if (pair.penetration > known->penetration) {
        *known = pair;
      }
    }
  }
  std::ranges::stable_sort(deepest, std::ranges::greater(), &PairRow::penetration);
  return deepest;
}

// Makes a graph with a series for each pair of bodies that touched each other, or for the deepest ones where there are
// more pairs than colours. In a frame without a row of theirs they do not touch, and their value is 0.
FrameGraph pairs_graph(const std::vector<FrameRow>& rows, std::string title,
                       const std::function<double(const PairRow&)>& value) {
  std::vector<PairRow> shown = deepest_of_pairs(rows);
  if (shown.size() > curve_colors) title += fmt::format(" (the {} deepest pairs)", curve_colors);
  shown.resize(std::min(shown.size(), curve_colors));
  FrameGraph graph{std::move(title), "", false, {}};
  for (const PairRow& one : shown) {
    const std::string other = one.bodies[0] == one.bodies[1] ? "itself" : one.bodies[1];
    graph.series.push_back(by_frame(rows, one.bodies[0] + " and " + other, [&](const FrameRow& row) {
      const auto pair = std::ranges::find(row.pairs, one.bodies, &PairRow::bodies);
      return pair == row.pairs.end() ? 0 : value(*pair);
    }));
  }
  return graph;
}

// Makes the graph of one of the errors, with the estimate and what was measured of each body.
FrameGraph errors_graph(const std::vector<FrameRow>& rows, const char* title, double BodyRow::*estimate,
                        std::optional<double> BodyRow::*measured) {
  FrameGraph graph{title, "", true, {}};
  graph.series = by_body(rows, ", estimate", [&](const BodyRow& body) { return body.*estimate; });
  for (FrameSeries& series : by_body(rows, ", measured", [&](const BodyRow& body) {
         return body.error_measured ? (body.*measured).value_or(none) : none;
       }))
    graph.series.push_back(std::move(series));
  return graph;
}

}  // namespace

std::vector<FrameGraph> graphs_of(const std::vector<FrameRow>& rows) {
  FrameGraph times{"Time by stage", "ms", false, {}, true};
  times.series.push_back(by_frame(rows, "solving", [](const FrameRow& row) { return row.step_ms; }));
  if (rows.front().render_ms)
    times.series.push_back(by_frame(rows, "drawing", [](const FrameRow& row) {
      return row.draw_ms.value_or(none) + row.render_ms.value_or(none);
    }));
  if (rows.front().compress_ms)
    times.series.push_back(
        by_frame(rows, "compressing", [](const FrameRow& row) { return row.compress_ms.value_or(none); }));
  const FrameGraph errors =
      errors_graph(rows, "Error of a step: what is left to gain over what there was (equation 12)",
                   &BodyRow::error_estimate, &BodyRow::error);
  const FrameGraph motion_errors =
      errors_graph(rows, "Error of motion: how far the solved step ends, over the step's own motion",
                   &BodyRow::motion_estimate, &BodyRow::motion_error);
  FrameGraph stretch{"Largest stretch", "", false, by_body(rows, "", [](const BodyRow& body) { return body.stretch; })};
  FrameGraph contacts{"Vertices in contact", "", false, by_body(rows, "", [](const BodyRow& body) {
                        return body.contact ? body.contact->contacts : none;
                      })};
  FrameGraph depth{
      "Deepest point inside a collider, over the body's size", "", false,
      by_body(rows, "", [](const BodyRow& body) { return body.contact ? body.contact->penetration : none; })};
  const FrameGraph pair_contacts =
      pairs_graph(rows, "Points of two bodies that touch each other, or of one that touches itself",
                  [](const PairRow& pair) { return pair.contacts; });
  const FrameGraph pair_depth =
      pairs_graph(rows, "Deepest point inside another body or its own, over the smaller body's size",
                  [](const PairRow& pair) { return pair.penetration; });
  std::vector<FrameGraph> graphs;
  for (FrameGraph& graph :
       std::array{times, errors, motion_errors, stretch, contacts, depth, pair_contacts, pair_depth}) {
    if (!graph.series.empty()) graphs.push_back(std::move(graph));
  }
  return graphs;
}

namespace {

// Holds the range of a vertical axis, and the values that are marked on it.
struct Axis {
  double lower = 0, upper = 1;
  std::vector<double> ticks;
  bool logarithmic = false;

  // Returns the place of a value, from 0 at the bottom to 1 at the top.
  double place(double value) const {
    if (!logarithmic) return (value - lower) / (upper - lower);
    return std::log10(std::max(value, lower) / lower) / std::log10(upper / lower);
  }
};

Axis log_axis(double smallest, double largest) {
  Axis axis{std::pow(10, std::floor(std::log10(std::max(smallest, largest * 1e-12)))),
            std::pow(10, std::ceil(std::log10(largest))),
            {},
            true};
  if (axis.upper <= axis.lower) axis.upper = 10 * axis.lower;
  const int decades = static_cast<int>(std::round(std::log10(axis.upper / axis.lower)));
  const int step = std::max(1, decades / 4);
  for (int d = 0; d <= decades; d += step) axis.ticks.push_back(axis.lower * std::pow(10, d));
  return axis;
}

Axis axis_of(const FrameGraph& graph) {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (const FrameSeries& series : graph.series) {
    const std::size_t from = graph.first_apart && series.values.size() > 1 ? 1 : 0;
    for (const double value : std::span(series.values).subspan(from)) {
      if (!std::isfinite(value) || value <= 0) continue;
      smallest = std::min(smallest, value);
      largest = std::max(largest, value);
    }
  }
  if (largest == 0) return {0, 1, {0, 1}, false};
  if (graph.logarithmic) return log_axis(smallest, largest);
  // Values that differ little among themselves, as stretches near 1 do, get an axis that does not begin at 0.
  const double bottom = smallest > 0.6 * largest ? smallest : 0;
  const double raw = std::max(largest - bottom, 1e-3 * largest) / 4, power = std::pow(10, std::floor(std::log10(raw)));
  const double step = power * (raw <= power ? 1 : raw <= 2 * power ? 2 : raw <= 5 * power ? 5 : 10);
  Axis axis{step * std::floor(bottom / step), step * std::ceil(largest / step), {}, false};
  if (axis.upper <= axis.lower) axis.upper = axis.lower + step;
  const auto steps = static_cast<int>(std::lround((axis.upper - axis.lower) / step));
  for (int t = 0; t <= steps; ++t) axis.ticks.push_back(axis.lower + t * step);
  return axis;
}

// Returns the curve as a path of SVG in a square from (0, 0), the upper left corner, to (1000, 1000). The curve leads
// on over frames without a value, and is interrupted by values that a logarithmic axis cannot show.
std::string path_of(const FrameSeries& series, const Axis& axis) {
  std::string path;
  bool drawing = false;
  const double last = std::max<double>(1, static_cast<double>(series.values.size()) - 1);
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    const double value = series.values[i];
    if (!std::isfinite(value)) continue;
    const bool shown = !axis.logarithmic || value > 0;
    if (shown)
      path += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", 1000.0 * static_cast<double>(i) / last,
                          1000 * (1 - std::clamp(axis.place(value), 0.0, 1.0)));
    drawing = shown;
  }
  return path;
}

std::string tick_text(double value) {
  return value != 0 && (value < 1e-3 || value >= 1e5) ? fmt::format("{:.0e}", value) : fmt::format("{:.4g}", value);
}

}  // namespace

std::string graph_html(const FrameGraph& graph, std::size_t first, double from, double to) {
  const Axis axis = axis_of(graph);
  std::string html = "<div class=\"graph\"><div class=\"legend\"><b>" + markup_text(graph.title) +
                     (graph.unit.empty() ? "" : " [" + graph.unit + "]") + "</b>\n";
  for (std::size_t s = 0; s < graph.series.size(); ++s)
    html += fmt::format("<span><i style=\"background:{}\"></i>{} <output data-series=\"{}\"></output></span>\n",
                        curve_color(s), markup_text(graph.series[s].name), first + s);
  html += "</div><div class=\"area\">\n";
  for (const double tick : axis.ticks) {
    const double top = 100 * (1 - axis.place(tick));
    html += fmt::format(
        "<div class=\"rule\" style=\"top:{0:.2f}%\"></div><div class=\"tick\" style=\"top:{0:.2f}%\">{1}</div>\n", top,
        tick_text(tick));
  }
  html += "<svg viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\n";
  for (std::size_t s = 0; s < graph.series.size(); ++s)
    html += fmt::format("<path style=\"stroke:{}\" d=\"{}\"/>\n", curve_color(s), path_of(graph.series[s], axis));
  html += "</svg><div class=\"cursor\"></div></div>\n";
  return html + fmt::format("<div class=\"times\"><span>{:.2f} s</span><span>{:.2f} s</span></div></div>\n", from, to);
}

}  // namespace supple
