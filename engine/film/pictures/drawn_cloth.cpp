#include "film/pictures/drawn_cloth.h"

#include <algorithm>
#include <cmath>

#include "geometry/skins/loop_subdivision.h"
#include "geometry/triangles/mean_curvature.h"

namespace supple {

namespace {

// Tells whether a cloth is drawn with yarns where the scene does not say. An elastic sheet has none. Those of a surface
// that goes round would be wider where it widens, and break at its seams.
bool shows_yarns(const BodyDef& body) {
  const bool is_woven = !body.cloth->fabric || std::holds_alternative<Woven>(body.cloth->fabric->fabric.membrane);
  return is_woven && body.cloth->surface.empty();
}

}  // namespace

std::optional<ClothLook> cloth_look(const BodyDef& body, const Positions& rest) {
  if (!body.cloth) return std::nullopt;
  const double size = bounds_of(rest).diagonal();
  return ClothLook{body.back_color, body.yarn.value_or(shows_yarns(body) ? size / 700 : 0), size / 130};
}

double gloss_of(const BodyDef& body) { return body.gloss.value_or(body.cloth ? 0.08 : DrawMesh{}.gloss); }

namespace {

// Returns the triangles as they were before the last subdivision. They cast the shadow, because its border does not
// show edges that are a few pixels long. Each triangle was cut into four, and the first corners of the first three of
// these are the corners of the triangle.
Triangles before_last_level(const Triangles& triangles) {
  Triangles before(triangles.rows() / 4, 3);
  for (Eigen::Index t = 0; t < before.rows(); ++t)
    before.row(t) << triangles(4 * t, 0), triangles(4 * t + 1, 0), triangles(4 * t + 2, 0);
  return before;
}

}  // namespace

void smooth_for_pixels(DrawnBody& drawn, const Positions& rest, double pixel) {
  if (drawn.weights.rows() > 0) return;
  constexpr double longest = 12;  // pixels, where the cloth is nearest; at its middle they are about half as long
  constexpr int most_levels = 3;
  constexpr Eigen::Index most_triangles = 400'000;
  double edge = mean_edge(drawn.skin.rest.triangles, drawn.skin.rest.points);
  Eigen::Index triangles = drawn.skin.rest.triangles.rows();
  int levels = 0;
  while (levels < most_levels && edge > longest * pixel && 4 * triangles <= most_triangles) {
    ++levels;
    edge /= 2;
    triangles *= 4;
  }
  if (levels == 0) return;
  drawn.weights = subdivide(drawn.skin, drawn.vertex_of, rest, levels);
  drawn.casters = before_last_level(drawn.skin.rest.triangles);
}

// Returns a place of the smooth surface. Where a cloth rises from the ground, this surface dips below the vertices by a
// part of an edge, and the ground would hide it. So a place below the ground is lifted to its lowest vertex, or to the
// ground where all of its vertices are above it.
Vec3 smooth_place(const SurfaceWeights& weights, Eigen::Index row, const Positions& now) {
  Vec3 place = weighted_point(weights, row, now);
  if (place.y() >= 0) return place;
  double lowest = infinity;
  for (std::int32_t i = weights.begin[std::size_t(row)]; i < weights.begin[std::size_t(row) + 1]; ++i)
    lowest = std::min(lowest, now(weights.vertex[std::size_t(i)], 1));
  place.y() = std::max(place.y(), std::min(lowest, 0.0));
  return place;
}

std::vector<float> cloth_hollows(const DrawnBody& drawn, const Body& body, const Positions& now) {
  if (drawn.skin.flat.empty()) return {};
  constexpr double fold = 1.0 / 30;  // radius of folds that are half as deep as the deepest, over the cloth's size
  const Triangles surface = surface_of(body);
  const double radius = fold * bounds_of(body.description.mesh.rest).diagonal();
  std::vector<double> values = mean_curvature(now, surface);
  for (double& value : values) value = radius * value / (1 + radius * std::abs(value));
  smooth_values(surface, 2, values);  // a grid wrinkles along its own lines, and smoothing hides these wrinkles
  std::vector<float> result;
  for (std::size_t v = 0; v < drawn.skin.flat.size(); ++v)
    result.push_back(static_cast<float>(drawn.weights.rows() > 0
                                            ? weighted_value(drawn.weights, Eigen::Index(v), values)
                                            : values[std::size_t(drawn.vertex_of[v])]));
  return result;
}

}  // namespace supple
