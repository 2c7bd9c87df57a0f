#include "geometry/triangles/triangle_soup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace supple {
namespace {

// Returns the length, over that of `direction`, after which a ray meets a triangle from either side; infinity where it
// does not. Follows Moeller and Trumbore, Fast, minimum storage ray-triangle intersection, 1997.
double hit_of_triangle(const Vec3& from, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, across = direction.cross(ac);
  const double facing = ab.dot(across);
  if (facing == 0) return infinity;
  const Vec3 away = from - a, turned = away.cross(ab);
  const double v = away.dot(across) / facing, w = direction.dot(turned) / facing, length = ac.dot(turned) / facing;
  return v >= 0 && w >= 0 && v + w <= 1 && length > 0 ? length : infinity;
}

double squared_distance(const Bounds& box, const Vec3& p) {
  return (box.lower - p).cwiseMax(p - box.upper).cwiseMax(0).squaredNorm();
}

}  // namespace

// Follows Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
Vec3 closest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return sum > 0 ? Vec3(a + vb / sum * ab + vc / sum * ac) : a;
}

Vec3 weights_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, normal = ab.cross(ac);
  const double area = normal.squaredNorm();
  if (!(area > 0)) return Vec3(1, 0, 0);
  const double v = std::max(0.0, ap.cross(ac).dot(normal) / area), w = std::max(0.0, ab.cross(ap).dot(normal) / area);
  const double u = std::max(0.0, 1 - v - w);
  return Vec3(u, v, w) / (u + v + w);
}

TriangleSoup::TriangleSoup(TriMesh mesh) : mesh_(std::move(mesh)) {
  const Eigen::Index count = mesh_.triangles.rows();
  SUPPLE_CHECK(count, >, 0);
  normals_.resize(count, 3);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const Vec3 area = 0.5 * (b - a).cross(c - a);
    const double size = area.stableNorm();
    normals_.row(t) = (size > 0 ? Vec3(area / size) : Vec3(0, 0, 0)).transpose();
  }
  tree_ = triangle_tree(mesh_, TreeCut::longest_side);
}

std::optional<double> TriangleSoup::first_hit(const Vec3& from, const Vec3& direction, Eigen::Index except) const {
  const Vec3 inverse = direction.unaryExpr([](double x) { return 1 / (std::abs(x) > 1e-290 ? x : 1e-290); });
  TreeStack<std::int32_t> stack(0);
  double best = infinity;
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    const TriangleTree::Node& node = tree_.nodes[std::size_t(index)];
    const Vec3 l = (node.box.lower - from).cwiseProduct(inverse), u = (node.box.upper - from).cwiseProduct(inverse);
    if (l.cwiseMin(u).maxCoeff() > std::min(best, l.cwiseMax(u).minCoeff()) || l.cwiseMax(u).minCoeff() < 0) continue;
    if (!node.is_leaf()) {
      stack.push(node.other);
      stack.push(index + 1);
      continue;
    }
    for (const std::int32_t t : tree_.triangles_of(node)) {
      if (t != except)
        best = std::min(best, hit_of_triangle(from, direction, corner(t, 0), corner(t, 1), corner(t, 2)));
    }
  }
  return best < infinity ? std::optional(best) : std::nullopt;
}

TriangleSoup::Near TriangleSoup::closest(const Vec3& p, double within, const Vec3& facing) const {
  const bool any = facing.isZero();
  Near best;
  best.squared = within * within;
  TreeStack<std::int32_t> stack(0);
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    const TriangleTree::Node& node = tree_.nodes[std::size_t(index)];
    if (!(squared_distance(node.box, p) < best.squared)) continue;
    if (!node.is_leaf()) {
      const std::int32_t next = index + 1;
      const bool next_first = squared_distance(tree_.nodes[std::size_t(next)].box, p) <=
                              squared_distance(tree_.nodes[std::size_t(node.other)].box, p);
      stack.push(next_first ? node.other : next);
      stack.push(next_first ? next : node.other);
      continue;
    }
    for (const std::int32_t t : tree_.triangles_of(node)) {
      if (!any && !(normals_.row(t).dot(facing) > 0)) continue;
      const Vec3 point = closest_in_triangle(p, corner(t, 0), corner(t, 1), corner(t, 2));
      const double squared = (point - p).squaredNorm();
      if (squared < best.squared) best = {t, point, squared};
    }
  }
  return best;
}

}  // namespace supple
