// Implements orient_parts of winding_solid.h.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/solids/winding_solid.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

// Returns the i-th term of the base's radical inverse sequence, 0 to 1: Halton, 1960. It is the same on every machine.
double radical_inverse(int i, int base) {
  double result = 0, share = 1.0 / base;
  for (; i > 0; i /= base, share /= base) result += share * (i % base);
  return result;
}

// Returns a direction on the normal's side, with a density proportional to the cosine of its angle to the normal. u, v:
// numbers that are spread evenly over 0 to 1.
Vec3 direction_around(const Vec3& normal, double u, double v) {
  const Vec3 side = normal.unitOrthogonal();
  const double radius = std::sqrt(u), angle = 2 * std::numbers::pi * v;
  return radius * std::cos(angle) * side + radius * std::sin(angle) * normal.cross(side) + std::sqrt(1 - u) * normal;
}

// Tells whether rays from a part's back escape clearly more often than those from its front.
bool faces_inward(const TriangleSoup& soup, const Component& part, double size) {
  constexpr int rays = 48;
  std::vector<double> sums;  // of the areas up to each triangle
  double area = 0;
  for (const Eigen::Index t : part.triangles) sums.push_back(area += area_vector(soup.mesh(), t).norm());
  int front = 0, back = 0;
  for (int i = 0; i < rays; ++i) {
    const double wanted = area * (i + 0.5) / rays;
    const auto found = std::size_t(std::lower_bound(sums.begin(), sums.end(), wanted) - sums.begin());
    const Eigen::Index t = part.triangles[std::min(found, sums.size() - 1)];
    double v = radical_inverse(i + 1, 2), w = radical_inverse(i + 1, 3);
    if (v + w > 1) v = 1 - v, w = 1 - w;
    const Vec3 point =
        (1 - v - w) * corner(soup.mesh(), t, 0) + v * corner(soup.mesh(), t, 1) + w * corner(soup.mesh(), t, 2);
    const Vec3 normal = soup.normals().row(t);
    const Vec3 ahead = direction_around(normal, radical_inverse(i + 1, 5), radical_inverse(i + 1, 7));
    const Vec3 behind = ahead - 2 * ahead.dot(normal) * normal;
    front += soup.first_hit(point + 1e-9 * size * normal, ahead, t) ? 0 : 1;
    back += soup.first_hit(point - 1e-9 * size * normal, behind, t) ? 0 : 1;
  }
  constexpr int clearly = rays / 6;
  return back > front + clearly;
}

}  // namespace

Eigen::Index orient_parts(Numbered& surface, Threads& threads) {
  const Flood parts = flood(surface, neighbours_of(surface));
  Triangles& triangles = surface.mesh.triangles;
  std::vector<char> turned = parts.turned;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    if (turned[at(t)]) turn_over(triangles, t);
  const TriangleSoup soup(surface.mesh);
  const double size = bounds_of(surface.mesh.points).diagonal();
  std::vector<char> inward(parts.components.size(), 0);
  threads.run(int(parts.components.size()),
              [&](int c) { inward[std::size_t(c)] = faces_inward(soup, parts.components[std::size_t(c)], size); });
  for (std::size_t c = 0; c < inward.size(); ++c) {
    if (!inward[c]) continue;
    for (const Eigen::Index t : parts.components[c].triangles) {
      turn_over(triangles, t);
      turned[at(t)] ^= 1;
    }
  }
  return std::count(turned.begin(), turned.end(), 1);
}

}  // namespace supple
