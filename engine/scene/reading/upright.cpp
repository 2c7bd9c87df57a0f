#include "scene/reading/upright.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/convex_hull.h"

namespace supple {
namespace {

constexpr double far_taller = 1.5;  // times each of the other two extents
constexpr double steady = 0.12;     // a solid that stands as well as this hardly does so by chance
constexpr double wobbly = 0.03;     // a solid that stands no better than this falls at the first jolt
constexpr double sturdy = 0.15;     // a solid that stands so well has wheels or legs, and is no tower on its side

Vec3 center_of_mass(const TriMesh& surface) {
  Vec3 moment = Vec3::Zero();
  double volume = 0;
  const Vec3 origin = bounds_of(surface.points).center();
  for (const auto& t : surface.triangles.rowwise()) {
    const Vec3 a = surface.points.row(t[0]).transpose() - origin, b = surface.points.row(t[1]).transpose() - origin,
               c = surface.points.row(t[2]).transpose() - origin;
    const double sixfold = a.dot(b.cross(c));
    moment += sixfold * (a + b + c) / 4;
    volume += sixfold;
  }
  return volume > 0 ? Vec3(origin + moment / volume) : origin;
}

std::string ending_in_small_letters(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

// Tells whether files of this kind say which axis is up: assimp turns what it reads of them, so that y is up.
bool says_axis(const std::filesystem::path& file) {
  constexpr std::array saying = {".gltf", ".glb", ".dae", ".fbx", ".3ds", ".blend", ".x3d"};
  return std::ranges::find(saying, ending_in_small_letters(file)) != saying.end();
}

// Returns the axis that is usually up in files of this kind: z in those of printers and CAD programs, else y.
UpAxis usual_axis(const std::filesystem::path& file) {
  const std::string ending = ending_in_small_letters(file);
  return ending == ".stl" || ending == ".3mf" ? UpAxis::z : UpAxis::y;
}

}  // namespace

double steadiness(const TriMesh& surface, UpAxis up, double sole) {
  const int axis = static_cast<int>(up), across = (axis + 1) % 3, along = (axis + 2) % 3;
  const Bounds box = bounds_of(surface.points);
  const double highest = box.lower[axis] + sole * box.extent()[axis];
  std::vector<Eigen::Vector2d> standing;
  for (const auto& p : surface.points.rowwise())
    if (p[axis] <= highest) standing.emplace_back(p[across], p[along]);
  const std::vector<Eigen::Vector2d> hull = hull_of(standing);
  if (hull.size() < 3) return -1;
  const Vec3 mass = center_of_mass(surface);
  const Eigen::Vector2d middle(mass[across], mass[along]);
  double within = 1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d edge = hull[(i + 1) % hull.size()] - hull[i], from = middle - hull[i];
    within = std::min(within, (edge.x() * from.y() - edge.y() * from.x()) / edge.norm());
  }
  return within / (0.5 * (box.extent()[across] + box.extent()[along]));
}

double steady_sole(const TriMesh& surface) {
  constexpr double least = 0.05;  // steadiness at which thin ankles need not carry the body's lean
  for (const double sole : {0.05, 0.08, 0.12})
    if (steadiness(surface, UpAxis::y, sole) >= least) return sole;
  return 0.16;
}

Upright guess_upright(const std::filesystem::path& file, const TriMesh& surface) {
  if (says_axis(file)) return {UpAxis::y, ""};
  const UpAxis usual = usual_axis(file), other = usual == UpAxis::y ? UpAxis::z : UpAxis::y;
  const Vec3 extent = bounds_of(surface.points).extent();
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z}) {
    const int k = static_cast<int>(up);
    const double rest = std::max(extent[(k + 1) % 3], extent[(k + 2) % 3]);
    if (up != usual && extent[k] > far_taller * rest && steadiness(surface, usual) < sturdy &&
        steadiness(surface, up) > steady)
      return {up, fmt::format("the model is {:.2g} times as long along it as across, and stands", extent[k] / rest)};
  }
  if (steadiness(surface, usual) < wobbly && steadiness(surface, other) > steady)
    return {other, fmt::format("the model stands on it, and would topple with {} up", name_of(usual))};
  return {usual, usual == UpAxis::z ? "files of this kind usually have it so" : ""};
}

}  // namespace supple
