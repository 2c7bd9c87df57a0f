#include "scene/building/cloth_cut.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/stretches.h"
#include "geometry/triangles/numbered_surface.h"

namespace supple {
namespace {

constexpr double most_stretch = 1.5, least_stretch = 0.67;

using FlatCorners = std::array<Eigen::Vector2d, 3>;

// Returns twice the area of a triangle of the texture; below 0 where it is mirrored.
double doubled_area(const FlatCorners& at) {
  const Eigen::Vector2d first = at[1] - at[0], second = at[2] - at[0];
  return first.x() * second.y() - first.y() * second.x();
}

// Tells whether the area of a triangle of the texture is only round-off.
bool has_no_area(const FlatCorners& at) {
  const double longest = std::max({(at[1] - at[0]).norm(), (at[2] - at[1]).norm(), (at[0] - at[2]).norm()});
  return !(std::abs(doubled_area(at)) > 1e-6 * longest * longest);
}

[[noreturn]] void refuse(const BodyDef& def, const TriMesh& surface, const std::vector<Eigen::Index>& wrong,
                         const char* what) {
  const Eigen::Index t = wrong.front(), all = surface.triangles.rows();
  const Vec3 middle = (corner(surface, t, 0) + corner(surface, t, 1) + corner(surface, t, 2)) / 3;
  const std::string which = std::ssize(wrong) == all
                                ? fmt::format("all triangles have {}", what)
                                : fmt::format("{} of {} triangles have {}, the first at ({:.3g}, {:.3g}, {:.3g})",
                                              wrong.size(), all, what, middle.x(), middle.y(), middle.z());
  throw InputError({{def.cloth->cut_place,
                     fmt::format("cut = \"texture\": in '{}' {}; cut = \"surface\" takes each triangle as it lies",
                                 def.cloth->surface.filename().string(), which)}});
}

}  // namespace

std::vector<FlatCorners> flat_cut(const TriMesh& surface, const FileCorners& corners, const ColoredSurface& file,
                                  const BodyDef& def, std::vector<std::string>& notes) {
  const Eigen::Index triangles = surface.triangles.rows();
  std::vector<FlatCorners> flat;
  std::vector<Eigen::Index> unplaced, pressed;
  long mirrored = 0;
  for (Eigen::Index t = 0; t < triangles; ++t) {
    FlatCorners& at = flat.emplace_back();
    bool placed = !file.places.empty();
    for (std::size_t k = 0; k < 3 && placed; ++k) {
      at[k] = texture_place(corners[std::size_t(t)][k], file);
      placed = at[k].allFinite();
    }
    if (!placed) {
      unplaced.push_back(t);
    } else if (has_no_area(at)) {
      pressed.push_back(t);
    } else if (doubled_area(at) < 0) {
      ++mirrored;
    }
  }
  if (!unplaced.empty()) refuse(def, surface, unplaced, "no texture coordinates");
  if (!pressed.empty()) refuse(def, surface, pressed, "no area in the texture");
  if (mirrored > 0 && mirrored < triangles)
    notes.push_back(
        fmt::format("{} of its {} triangles are mirrored in the texture: they are at rest as the mirror "
                    "images of what lies there",
                    mirrored, triangles));
  return flat;
}

double scale_of_equal_area(const Body& body) {
  double flat = 0, placed = 0;
  for (const FlatCorners& at : body.flat) flat += std::abs(doubled_area(at)) / 2;
  for (const double share : vertex_areas({body.description.mesh.rest, body.cloth.surface.triangles})) placed += share;
  return std::sqrt(placed / flat);
}

double cut_scale(const Body& body) { return body.def.cloth->cut_scale.value_or(scale_of_equal_area(body)); }

CutStretch cut_stretch(const Body& body) {
  CutStretch result;
  std::vector<double> ratios;
  long far = 0;
  const Positions& placed = body.description.mesh.rest;
  for (const FlatTriangle& triangle : body.description.cloth) {
    Eigen::Matrix<double, 3, 2> edges;
    for (int k = 0; k < 2; ++k)
      edges.col(k) = placed.row(triangle.corner[std::size_t(k) + 1]) - placed.row(triangle.corner[0]);
    Eigen::Matrix2d flat;
    flat << triangle.edges[0], triangle.edges[1], triangle.edges[2], triangle.edges[3];
    const Eigen::Matrix<double, 3, 2> gradient = edges * flat.inverse();
    const std::array<double, 2> both = flat_stretches(gradient.transpose() * gradient);
    ratios.insert(ratios.end(), {both[0], both[1]});
    far += both[0] > most_stretch || both[1] < least_stretch ? 1 : 0;
  }
  if (ratios.empty()) return result;
  std::ranges::sort(ratios);
  result.least = ratios.front();
  result.median = ratios[ratios.size() / 2];
  result.largest = ratios.back();
  result.far = double(far) / double(body.description.cloth.size());
  return result;
}

std::string cut_text(const Body& body) {
  const CutStretch stretch = cut_stretch(body);
  return fmt::format(
      "a unit of its texture is {:.4g} m{}; as it lies it is stretched against this cut by {:.2f} at least, {:.2f} in "
      "the "
      "median and {:.2f} at most",
      cut_scale(body), body.def.cloth->cut_scale ? "" : ", which gives the cut the area of the surface", stretch.least,
      stretch.median, stretch.largest);
}

}  // namespace supple
