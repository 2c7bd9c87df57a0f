#include "geometry/triangles/edge_crossings.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

// Returns six times the signed volume of a tetrahedron [m^3].
double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return (b - a).cross(c - a).dot(d - a); }

}  // namespace

EdgeCrossings::EdgeCrossings(const Triangles& triangles, const Positions& rest)
    : triangles_(triangles), moving_(triangles, rest), edges_(edges_by_triangle(triangles).edges) {
  std::ranges::sort(edges_);
}

bool EdgeCrossings::share_vertex(const Edge& edge, std::int32_t triangle) const {
  const auto corner = triangles_.row(triangle).array();
  return (corner == edge[0]).any() || (corner == edge[1]).any();
}

bool EdgeCrossings::are_beside(const Edge& edge, std::int32_t triangle) const {
  for (const std::int32_t v : edge) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t corner = triangles_(triangle, k);
      if (std::ranges::binary_search(edges_, Edge{std::min(v, corner), std::max(v, corner)})) return true;
    }
  }
  return false;
}

// Tells whether an edge passes through the inside of a triangle: its ends are on different sides of the triangle, and
// the line through them goes around the triangle's three edges in one sense.
bool EdgeCrossings::passes(const Edge& edge, std::int32_t triangle, const Positions& x) const {
  const auto corner = triangles_.row(triangle);
  const Vec3 a = x.row(corner[0]), b = x.row(corner[1]), c = x.row(corner[2]);
  const Vec3 from = x.row(edge[0]), to = x.row(edge[1]);
  if (volume(a, b, c, from) * volume(a, b, c, to) >= 0) return false;
  const double ab = volume(from, to, a, b), bc = volume(from, to, b, c), ca = volume(from, to, c, a);
  return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

EdgeCrossings::Count EdgeCrossings::count(const Positions& x) {
  moving_.set_start(x);
  moving_.set_end(x);
  Count found;
  for (const Edge& edge : edges_) {
    const std::array<Vec3, 2> ends{x.row(edge[0]), x.row(edge[1])};
    moving_.visit_triangles_near(ends, ends, Vec3::Zero(), 0, [&](std::int32_t triangle) {
      if (share_vertex(edge, triangle) || !passes(edge, triangle, x)) return;
      ++(are_beside(edge, triangle) ? found.beside : found.apart);
    });
  }
  return found;
}

}  // namespace supple
