#include "geometry/triangles/triangle_soup.h"
#include "geometry/triangles/tree_stack.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/threads.h"

namespace supple {
namespace {

constexpr int leaf_size = 4;
constexpr double far = 2.5;  // a part counts as far beyond this many of its radii: section 3.2 of the paper has 2

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

// Builds the tree, with its halves' halves on all threads. Each node has its place before it is made: a subtree of some
// triangles has as many nodes as any other of as many.
class TriangleSoup::Builder {
 public:
  explicit Builder(TriangleSoup& soup) : soup_(soup), keys_(soup.order_.size()) {
    boxes_.reserve(keys_.size());
    for (Eigen::Index t = 0; t < soup.mesh_.triangles.rows(); ++t) {
      Bounds& box = boxes_.emplace_back();
      for (int k = 0; k < 3; ++k) box.include(soup.corner(t, k));
    }
  }

  void build() {
    const auto all = std::int32_t(keys_.size());
    soup_.nodes_.resize(std::size_t(nodes_of(all)));
    constexpr std::int32_t worth_threads = 50000;  // triangles
    std::vector<Part> waiting;
    add({0, 0, all}, all > worth_threads ? all / 8 : all, waiting);
    Threads threads(waiting.size() > 1 ? int(std::max(1u, std::thread::hardware_concurrency())) : 1);
    threads.run(int(waiting.size()), [&](int p) {
      std::vector<Part> none;
      add(waiting[std::size_t(p)], 0, none);
    });
  }

 private:
  // Says which triangles of the order make the subtree of a node.
  struct Part {
    std::int32_t node, first, count;
  };

  static std::int32_t nodes_of(std::int32_t triangles) {
    return triangles <= leaf_size ? 1 : 1 + nodes_of(triangles / 2) + nodes_of(triangles - triangles / 2);
  }

  // Leaves parts of at most `small` triangles waiting.
  void add(const Part& part, std::int32_t small, std::vector<Part>& waiting) {
    if (part.count <= small) return waiting.push_back(part);
    Node& node = soup_.nodes_[std::size_t(part.node)];
    summarise(node, part.first, part.count);
    if (part.count <= leaf_size) {
      node.first = part.first;
      node.count = part.count;
      return;
    }
    int axis = 0;
    node.box.extent().maxCoeff(&axis);
    const auto keys = keys_.begin() + part.first;
    const auto order = soup_.order_.begin() + part.first;
    for (std::ptrdiff_t i = 0; i < part.count; ++i) keys[i] = {soup_.centroids_(order[i], axis), order[i]};
    std::nth_element(keys, keys + part.count / 2, keys + part.count);
    for (std::ptrdiff_t i = 0; i < part.count; ++i) order[i] = keys[i].second;
    const Part one{part.node + 1, part.first, part.count / 2};
    const Part other{one.node + nodes_of(one.count), one.first + one.count, part.count - one.count};
    node.other = other.node;
    add(one, small, waiting);
    add(other, small, waiting);
  }

  void summarise(Node& node, std::int32_t first, std::int32_t count) const {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    node.area.setZero();
    for (std::int32_t i = first; i < first + count; ++i) {
      const std::int32_t t = soup_.order_[std::size_t(i)];
      const double own = soup_.areas_.row(t).norm();
      node.area += soup_.areas_.row(t).transpose();
      sum += own * soup_.centroids_.row(t).transpose();
      weight += own;
      node.box.lower = node.box.lower.cwiseMin(boxes_[std::size_t(t)].lower);
      node.box.upper = node.box.upper.cwiseMax(boxes_[std::size_t(t)].upper);
    }
    node.center = weight > 0 ? Vec3(sum / weight) : node.box.center();
    node.moment.setZero();
    double radius = 0;
    for (std::int32_t i = first; i < first + count; ++i) {
      const std::int32_t t = soup_.order_[std::size_t(i)];
      node.moment += (soup_.centroids_.row(t).transpose() - node.center) * soup_.areas_.row(t);
      for (int k = 0; k < 3; ++k) radius = std::max(radius, (soup_.corner(t, k) - node.center).squaredNorm());
    }
    node.reach = far * std::sqrt(radius);
  }

  TriangleSoup& soup_;
  std::vector<std::pair<double, std::int32_t>> keys_;  // scratch
  std::vector<Bounds> boxes_;                          // of the triangles [m]
};

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
  Builder(*this).build();
}

std::optional<double> TriangleSoup::first_hit(const Vec3& from, const Vec3& direction, Eigen::Index except) const {
  const Vec3 inverse = direction.unaryExpr([](double x) { return 1 / (std::abs(x) > 1e-290 ? x : 1e-290); });
  std::array<std::int32_t, tree_stack_size> stack;
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
  std::array<std::int32_t, tree_stack_size> stack;
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
