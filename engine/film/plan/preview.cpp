#include "film/plan/preview.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/definition/body_def.h"
#include "scene/definition/output_def.h"
#include "scene/definition/scene_def.h"

namespace supple {
namespace {

constexpr int fewest_vertices = 250;

constexpr int least_width = 480;  // of the pictures, below which faces and folds are not made out

// Returns the width and height of the pictures: a quarter of the scene's, but not below the least width, unless the
// scene's are narrower.
std::pair<int, int> preview_size(const OutputDef& output) {
  const int width = std::min(output.width, std::max(least_width, output.width / 4)) / 2 * 2;
  const double share = static_cast<double>(width) / output.width;
  return {std::max(16, width), std::max(16, static_cast<int>(std::lround(output.height * share / 2)) * 2)};
}

// Returns the vertices that the table of a body asks for: the sum over the pieces of its surface. Scattered copies
// share a table, and have so many vertices each.
int vertices_of_table(const SceneDef& scene, const std::string& table) {
  int sum = 0, copies = 0;
  for (const BodyDef& body : scene.bodies) {
    if (body.table != table) continue;
    sum += body.vertices;
    copies += body.piece == 0 ? 1 : 0;
  }
  return sum / std::max(1, copies);
}

// Returns the setting that makes the mesh of a body coarser; empty where nothing does.
std::string coarser(const SceneDef& scene, const BodyDef& body, double share) {
  const auto fewer = [](int cells, double factor) {
    return std::min(cells, std::max(2, static_cast<int>(std::lround(cells * factor))));
  };
  if (body.box) {
    const double edge = std::cbrt(share);
    const Eigen::Vector3i& cells = body.box->cells;
    return fmt::format("body.{}.box.cells=[{}, {}, {}]", body.table, fewer(cells.x(), edge), fewer(cells.y(), edge),
                       fewer(cells.z(), edge));
  }
  const double side = std::sqrt(share);  // of surfaces
  if (body.cloth && body.cloth->edge) return fmt::format("body.{}.cloth.edge={}", body.table, *body.cloth->edge / side);
  if (body.cloth && body.cloth->mesh.empty() && body.cloth->surface.empty()) {
    const Eigen::Vector2i& cells = body.cloth->cells;
    return fmt::format("body.{}.cloth.cells=[{}, {}]", body.table, fewer(cells.x(), side), fewer(cells.y(), side));
  }
  if (body.cloth || !body.mesh.empty() || body.piece > 0) return "";
  const int vertices = vertices_of_table(scene, body.table);
  return fmt::format("body.{}.vertices={}", body.table,
                     std::min(vertices, std::max(fewest_vertices, static_cast<int>(std::lround(vertices * share)))));
}

}  // namespace

std::vector<std::string> picture_settings(const OutputDef& output, int width, int height) {
  // Where the scene has output.size, width and height tell the shape for which its camera was placed, and stay.
  if (output.aspect > 0) return {fmt::format("output.size={}x{}", width, height)};
  return {fmt::format("output.width={}", width), fmt::format("output.height={}", height)};
}

std::vector<std::string> preview_settings(const SceneDef& scene, double share) {
  const auto [width, height] = preview_size(scene.output);
  std::vector<std::string> settings = picture_settings(scene.output, width, height);
  for (const BodyDef& body : scene.bodies) {
    const std::string setting = share < 1 ? coarser(scene, body, share) : "";
    if (!setting.empty() && std::ranges::count(settings, setting) == 0) settings.push_back(setting);
  }
  return settings;
}

}  // namespace supple
