#include "geometry/triangle_soup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/error.h"

namespace supple {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int leaf_size = 4;
constexpr int stack_size = 64;  // the tree is balanced: 2^31 triangles make 31 levels, with one sibling waiting at each
constexpr double far = 2.5;     // a part counts as far beyond this many of its radii: section 3.2 of the paper has 2

// Computes the signed solid angle over 4 pi: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983,
// equation 8.
double winding_of_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double y = a.dot(b.cross(c));
  const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(y, x) / (2 * std::numbers::pi);
}

// Follows Moeller and Trumbore, Fast, minimum storage ray-triangle intersection, 1997, for triangles of both sides.
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
  centroids_.resize(count, 3);
  areas_.resize(count, 3);
  normals_.resize(count, 3);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const Vec3 area = 0.5 * (b - a).cross(c - a);
    const double size = area.stableNorm();
    centroids_.row(t) = ((a + b + c) / 3).transpose();
    areas_.row(t) = area.transpose();
    normals_.row(t) = (size > 0 ? Vec3(area / size) : Vec3(0, 0, 0)).transpose();
  }
  order_.resize(std::size_t(count));
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(std::size_t(count));
  add_node(0, std::int32_t(count));
}

void TriangleSoup::summarise(Node& node, std::int32_t first, std::int32_t count) const {
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  node.area.setZero();
  for (std::int32_t i = first; i < first + count; ++i) {
    const std::int32_t t = order_[std::size_t(i)];
    const double own = areas_.row(t).norm();
    node.area += areas_.row(t).transpose();
    sum += own * centroids_.row(t).transpose();
    weight += own;
    for (int k = 0; k < 3; ++k) node.box.include(corner(t, k));
  }
  node.center = weight > 0 ? Vec3(sum / weight) : node.box.center();
  node.moment.setZero();
  double radius = 0;
  for (std::int32_t i = first; i < first + count; ++i) {
    const std::int32_t t = order_[std::size_t(i)];
    node.moment += (centroids_.row(t).transpose() - node.center) * areas_.row(t);
    for (int k = 0; k < 3; ++k) radius = std::max(radius, (corner(t, k) - node.center).squaredNorm());
  }
  node.reach = far * std::sqrt(radius);
}

std::int32_t TriangleSoup::add_node(std::int32_t first, std::int32_t count) {
  const std::size_t index = nodes_.size();
  Node node;
  summarise(node, first, count);
  nodes_.push_back(node);
  if (count <= leaf_size) {
    nodes_[index].first = first;
    nodes_[index].count = count;
    return std::int32_t(index);
  }
  int axis = 0;
  node.box.extent().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](std::int32_t s, std::int32_t t) {
    return std::pair(centroids_(s, axis), s) < std::pair(centroids_(t, axis), t);
  });
  add_node(first, count / 2);
  const std::int32_t other = add_node(first + count / 2, count - count / 2);
  nodes_[index].other = other;
  return std::int32_t(index);
}

double TriangleSoup::winding_number(const Vec3& p) const {
  std::array<std::int32_t, stack_size> stack;
  int top = 0;
  stack[std::size_t(top++)] = 0;
  double sum = 0;
  while (top > 0) {
    const std::int32_t index = stack[std::size_t(--top)];
    const Node& node = nodes_[std::size_t(index)];
    const Vec3 d = node.center - p;
    const double squared = d.squaredNorm();
    if (squared > node.reach * node.reach) {
      // The gradient of the dipoles' field is I / d^3 - 3 d d' / d^5: equation 15 of the paper.
      const double cubed = squared * std::sqrt(squared);
      const double first = node.area.dot(d) + node.moment.trace();
      sum += (first - 3 * d.dot(node.moment * d) / squared) / (cubed * (4 * std::numbers::pi));
    } else if (node.count > 0) {
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        const std::int32_t t = order_[std::size_t(i)];
        sum += winding_of_triangle(corner(t, 0) - p, corner(t, 1) - p, corner(t, 2) - p);
      }
    } else {
      stack[std::size_t(top++)] = node.other;
      stack[std::size_t(top++)] = index + 1;
    }
  }
  return sum;
}

std::optional<double> TriangleSoup::first_hit(const Vec3& from, const Vec3& direction, Eigen::Index except) const {
  const Vec3 inverse = direction.unaryExpr([](double x) { return 1 / (std::abs(x) > 1e-290 ? x : 1e-290); });
  std::array<std::int32_t, stack_size> stack;
  int top = 0;
  stack[std::size_t(top++)] = 0;
  double best = infinity;
  while (top > 0) {
    const std::int32_t index = stack[std::size_t(--top)];
    const Node& node = nodes_[std::size_t(index)];
    const Vec3 l = (node.box.lower - from).cwiseProduct(inverse), u = (node.box.upper - from).cwiseProduct(inverse);
    if (l.cwiseMin(u).maxCoeff() > std::min(best, l.cwiseMax(u).minCoeff()) || l.cwiseMax(u).minCoeff() < 0) continue;
    if (node.count == 0) {
      stack[std::size_t(top++)] = node.other;
      stack[std::size_t(top++)] = index + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const std::int32_t t = order_[std::size_t(i)];
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
  std::array<std::int32_t, stack_size> stack;
  int top = 0;
  stack[std::size_t(top++)] = 0;
  while (top > 0) {
    const std::int32_t index = stack[std::size_t(--top)];
    const Node& node = nodes_[std::size_t(index)];
    if (!(squared_distance(node.box, p) < best.squared)) continue;
    if (node.count == 0) {
      const std::int32_t next = index + 1;
      const bool next_first = squared_distance(nodes_[std::size_t(next)].box, p) <=
                              squared_distance(nodes_[std::size_t(node.other)].box, p);
      stack[std::size_t(top++)] = next_first ? node.other : next;
      stack[std::size_t(top++)] = next_first ? next : node.other;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const std::int32_t t = order_[std::size_t(i)];
      if (!any && !(normals_.row(t).dot(facing) > 0)) continue;
      const Vec3 point = closest_in_triangle(p, corner(t, 0), corner(t, 1), corner(t, 2));
      const double squared = (point - p).squaredNorm();
      if (squared < best.squared) best = {t, point, squared};
    }
  }
  return best;
}

}  // namespace supple
