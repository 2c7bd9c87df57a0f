#include "scene/building/skin_offsets.h"

#include <algorithm>
#include <numeric>

#include "geometry/skins/skin_stretch.h"
#include "geometry/triangles/refine_surface.h"

namespace supple {
namespace {

// Finds nearest points: they are ordered along an axis, and looked at from the wanted place in both directions.
class NearestPoints {
 public:
  explicit NearestPoints(const Positions& points) : points_(points), order_(std::size_t(points.rows())) {
    bounds_of(points).extent().maxCoeff(&axis_);
    std::iota(order_.begin(), order_.end(), 0);
    std::ranges::stable_sort(order_, {}, [this](std::int32_t i) { return points_(i, axis_); });
  }

  std::int32_t nearest(const Vec3& place) const {
    const auto middle =
        std::ranges::lower_bound(order_, place[axis_], {}, [this](std::int32_t i) { return points_(i, axis_); });
    std::int32_t best = order_.front();
    double least = (Vec3(points_.row(best)) - place).squaredNorm();
    // Returns false where no point from here on can be nearer.
    const auto look_at = [&](std::int32_t i) {
      const double apart = points_(i, axis_) - place[axis_];
      if (apart * apart > least) return false;
      const double distance = (Vec3(points_.row(i)) - place).squaredNorm();
      if (distance < least) {
        least = distance;
        best = i;
      }
      return true;
    };
    for (auto at = middle; at != order_.end() && look_at(*at);) ++at;
    for (auto at = middle; at != order_.begin() && look_at(*std::prev(at));) --at;
    return best;
  }

 private:
  Positions points_;
  int axis_ = 0;
  std::vector<std::int32_t> order_;
};

Positions vertex_normals(const Triangles& triangles, const Positions& points) {
  Positions normals = Positions::Zero(points.rows(), 3);
  for (const auto& t : triangles.rowwise()) {
    const Vec3 a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
    for (int k = 0; k < 3; ++k) normals.row(t[k]) += (b - a).cross(c - a).transpose();
  }
  normals.rowwise().normalize();
  return normals;
}

// Returns places all over the drawn surface, nearer to each other than the elements' vertices are.
Positions places_on_skin(const Body& body) {
  constexpr double between = 0.5;           // longest edge between two places, over the elements' mean edge
  constexpr Eigen::Index most = 1'000'000;  // triangles
  const TetMesh unplaced{body.unplaced, body.description.mesh.tets, {}};
  Positions places = refined(body.skin, between * mean_edge(unplaced), most).mesh.points;
  for (Eigen::Index i = 0; i < places.rows(); ++i) places.row(i) = (body.placement * Vec3(places.row(i))).transpose();
  return places;
}

// Returns how far out a place lies, seen from a vertex, less half of how far it lies to the side. way: from the vertex
// to the place.
double outwardness(const Vec3& way, const Vec3& normal) {
  constexpr double of_the_side = 0.5;
  const double out = way.dot(normal);
  return out - of_the_side * (way - out * normal).norm();
}

void add_surface_offsets(const Body& body, const std::vector<std::int32_t>& outer, const Triangles& boundary,
                         Positions& offsets) {
  const Positions& rest = body.description.mesh.rest;
  const Positions places = places_on_skin(body), normals = vertex_normals(boundary, rest);
  Positions vertices(std::ssize(outer), 3);
  for (std::size_t i = 0; i < outer.size(); ++i) vertices.row(Eigen::Index(i)) = rest.row(outer[i]);
  const NearestPoints near_vertices(vertices), near_places(places);
  std::vector<char> has_place(outer.size(), 0);
  for (Eigen::Index p = 0; p < places.rows(); ++p) {
    const std::int32_t i = near_vertices.nearest(places.row(p));
    const std::int32_t v = outer[std::size_t(i)];
    const Vec3 way = places.row(p) - rest.row(v), normal = normals.row(v);
    if (has_place[std::size_t(i)] != 0 && outwardness(way, normal) <= outwardness(offsets.row(v), normal)) continue;
    has_place[std::size_t(i)] = 1;
    offsets.row(v) = way.transpose();
  }
  for (std::size_t i = 0; i < outer.size(); ++i) {
    if (has_place[i] == 0)
      offsets.row(outer[i]) = places.row(near_places.nearest(rest.row(outer[i]))) - rest.row(outer[i]);
  }
}

}  // namespace

Positions skin_offsets(const Body& body) {
  const bool is_shape = !body.def.shape.empty();
  if (body.def.cloth || (body.skin.triangles.rows() == 0 && !is_shape)) return Positions(0, 3);
  const Positions& rest = body.description.mesh.rest;
  const Triangles boundary = surface_of(body);
  std::vector<std::int32_t> outer(boundary.data(), boundary.data() + boundary.size());
  std::ranges::sort(outer);
  outer.erase(std::unique(outer.begin(), outer.end()), outer.end());
  Positions offsets = Positions::Zero(rest.rows(), 3);
  if (!is_shape) {
    add_surface_offsets(body, outer, boundary, offsets);
    return offsets;
  }
  for (const std::int32_t v : outer)
    offsets.row(v) =
        (body.placement * body.shape.closest(body.unplaced.row(v).transpose()).point).transpose() - rest.row(v);
  return offsets;
}

}  // namespace supple
