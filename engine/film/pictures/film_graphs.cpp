#include "film/pictures/film_graphs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/pictures/surface_field.h"
#include "scene/definition/scene_def.h"
#include "scene/definition/text_def.h"

namespace supple {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// The scale of errors is the same in all films, so that they can be compared, and is known before the film is.
constexpr double smallest_error = 1e-6, largest_error = 1;

double place_of_error(double error) {
  if (std::isnan(error)) return nothing;
  const double place = std::log10(std::max(error, smallest_error) / smallest_error);
  return std::min(1.0, place / std::log10(largest_error / smallest_error));
}

// Returns the upper end of the scale of times [ms].
double time_scale(double longest) { return longest > 0 ? rounded_up(longest) : 1; }

}  // namespace

GraphPoint graph_point(const FrameRow& row) {
  GraphPoint point{row.step_ms, 0, nothing};
  for (const BodyRow& body : row.bodies) {
    point.estimate = std::max({point.estimate, body.error_estimate, body.motion_estimate});
    if (body.error_measured)
      point.measured = std::fmax(point.measured, std::max(body.error.value_or(0), body.motion_error.value_or(0)));
  }
  return point;
}

double longest_steps(std::span<const FrameRow> rows) {
  double longest = rows.size() == 1 ? rows.front().step_ms : 0;
  for (std::size_t f = 1; f < rows.size(); ++f) longest = std::max(longest, rows[f].step_ms);
  return longest;
}

std::vector<GraphLook> graph_looks(const SceneDef& scene, double longest) {
  std::vector<GraphLook> graphs;
  if (scene.text.time_graph) {
    const double most = time_scale(longest);
    graphs.push_back({"ms a frame",
                      {{0, "0"}, {0.5, fmt::format("{:.6g}", most / 2)}, {1, fmt::format("{:.6g}", most)}},
                      scene.frames});
  }
  if (scene.text.error_graph)
    graphs.push_back({"error estimate", {{0, "1e-6"}, {1.0 / 3, "1e-4"}, {2.0 / 3, "1e-2"}, {1, "1"}}, scene.frames});
  return graphs;
}

std::vector<GraphCurve> graph_curves(const TextDef& text, std::span<const GraphPoint> earlier, const FrameRow* row,
                                     double longest) {
  std::vector<GraphCurve> curves;
  const auto by_frame = [&](const auto& value) {
    std::vector<double> values;
    if (row == nullptr) return values;
    for (const GraphPoint& one : earlier) values.push_back(value(one));
    values.push_back(value(graph_point(*row)));
    return values;
  };
  if (text.time_graph) {
    const double most = time_scale(longest);
    curves.push_back({by_frame([most](const GraphPoint& one) { return std::min(1.0, one.step_ms / most); }), {}});
  }
  if (text.error_graph)
    curves.push_back({by_frame([](const GraphPoint& one) { return place_of_error(one.estimate); }),
                      by_frame([](const GraphPoint& one) { return place_of_error(one.measured); })});
  return curves;
}

}  // namespace supple
