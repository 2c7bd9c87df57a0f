#include "geometry/triangle_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <thread>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/threads.h"

namespace supple {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The tree is balanced, so that 2^31 triangles make 15 levels; each level leaves at most three siblings on the stack.
constexpr int stack_size = 64;

template <class L>
auto dot(const L& a, const L& b) {
  return (a.x * b.x + a.y * b.y + a.z * b.z).eval();
}

template <class L>
void set(L& lanes, int k, const Vec3& value) {
  lanes.x[k] = value.x();
  lanes.y[k] = value.y();
  lanes.z[k] = value.z();
}

template <class L>
Vec3 get(const L& lanes, int k) {
  return Vec3(lanes.x[k], lanes.y[k], lanes.z[k]);
}

double half_area(const Bounds& box) {
  const Vec3 e = box.extent();
  return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
}

// Returns the edges, in the direction of their triangle, that no neighbour runs through in the other direction.
std::vector<std::pair<std::int32_t, std::int32_t>> open_edges(const Triangles& triangles) {
  struct Edge {
    std::int32_t low, high;
    int turn;  // 1 if it runs from low to high
    bool operator<(const Edge& other) const { return std::tie(low, high) < std::tie(other.low, other.high); }
  };
  std::vector<Edge> edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = triangles(t, k), to = triangles(t, (k + 1) % 3);
      edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::pair<std::int32_t, std::int32_t>> open;
  for (std::size_t i = 0; i < edges.size();) {
    const Edge edge = edges[i];
    int turns = 0;
    for (; i < edges.size() && !(edge < edges[i]); ++i) turns += edges[i].turn;
    for (; turns > 0; --turns) open.emplace_back(edge.low, edge.high);
    for (; turns < 0; ++turns) open.emplace_back(edge.high, edge.low);
  }
  return open;
}

}  // namespace

// Builds the tree. It splits at the middle, along the axis that leaves the two smallest boxes, into counts that fill
// the leaves.
class TriangleSolid::Builder {
 public:
  explicit Builder(TriangleSolid& solid) : solid_(solid), order_(std::size_t(solid.surface_.triangles.rows())) {
    std::iota(order_.begin(), order_.end(), 0);
    centroids_.resize(std::ssize(order_), 3);
    for (Eigen::Index t = 0; t < centroids_.rows(); ++t)
      centroids_.row(t) = ((solid.corner(t, 0) + solid.corner(t, 1) + solid.corner(t, 2)) / 3).transpose();
  }

  // The root's children are built one by one or all at once, and then stand in the order in which one thread makes
  // them.
  void build() {
    int count = 0;
    const Parts parts = parts_of(order_, count);
    std::array<Arrays, width> made;
    constexpr std::size_t worth_threads = 50000;  // triangles
    const bool shared = order_.size() > worth_threads;
    Threads threads(shared ? int(std::min(4u, std::max(1u, std::thread::hardware_concurrency()))) : 1);
    threads.run(count, [&](int k) {
      const Part own = parts[std::size_t(k)];
      if (own.size() > std::size_t(width)) add_node(own, made[std::size_t(k)]);
    });
    Arrays all;
    all.nodes.emplace_back();
    all.dipoles.emplace_back();
    Node root;
    Dipoles dipoles;
    for (int k = 0; k < width; ++k) {
      const Part own = k < count ? parts[std::size_t(k)] : Part();
      describe(own, k, root, dipoles);
      root.child[std::size_t(k)] = own.empty()                        ? 0
                                   : own.size() <= std::size_t(width) ? add_leaf(own, all)
                                                                      : append(made[std::size_t(k)], all);
    }
    all.nodes[0] = root;
    all.dipoles[0] = dipoles;
    solid_.nodes_ = std::move(all.nodes);
    solid_.dipoles_ = std::move(all.dipoles);
    solid_.leaves_ = std::move(all.leaves);
  }

 private:
  using Part = std::span<std::int32_t>;
  using Parts = std::array<Part, width>;

  struct Arrays {
    std::vector<Node> nodes;
    std::vector<Dipoles> dipoles;
    std::vector<Leaf> leaves;
  };

  // Puts a subtree behind what there is. Returns the place of its root.
  static std::int32_t append(const Arrays& subtree, Arrays& all) {
    const auto first_node = std::int32_t(all.nodes.size()), first_leaf = std::int32_t(all.leaves.size());
    all.nodes.insert(all.nodes.end(), subtree.nodes.begin(), subtree.nodes.end());
    all.dipoles.insert(all.dipoles.end(), subtree.dipoles.begin(), subtree.dipoles.end());
    all.leaves.insert(all.leaves.end(), subtree.leaves.begin(), subtree.leaves.end());
    for (std::size_t n = std::size_t(first_node); n < all.nodes.size(); ++n)
      for (std::int32_t& child : all.nodes[n].child)  // 0: there is none
        child = child > 0 ? child + first_node : child < 0 ? ~(~child + first_leaf) : 0;
    return first_node;
  }

  Bounds box_of(Part part) const {
    Bounds box;
    for (const std::int32_t t : part)
      for (int k = 0; k < 3; ++k) box.include(solid_.corner(t, k));
    return box;
  }

  void divide(Part part, std::size_t middle, int axis) const {
    std::nth_element(part.begin(), part.begin() + std::ptrdiff_t(middle), part.end(),
                     [&](std::int32_t s, std::int32_t t) {
                       return std::pair(centroids_(s, axis), s) < std::pair(centroids_(t, axis), t);
                     });
  }

  std::pair<Part, Part> split(Part part) const {
    const std::size_t middle = (part.size() / 2 + width - 1) / width * width;
    int best = 0;
    double cost = infinity;
    for (int axis = 0; axis < 3; ++axis) {
      divide(part, middle, axis);
      const double sum = half_area(box_of(part.first(middle))) + half_area(box_of(part.subspan(middle)));
      if (sum < cost) {
        cost = sum;
        best = axis;
      }
    }
    divide(part, middle, best);
    return {part.first(middle), part.subspan(middle)};
  }

  std::int32_t add_leaf(Part part, Arrays& arrays) const {
    Leaf leaf;
    leaf.count = int(part.size());
    for (int k = 0; k < width; ++k) {
      const std::int32_t t = part[k < leaf.count ? std::size_t(k) : 0];
      const Vec3 a = solid_.corner(t, 0), b = solid_.corner(t, 1), c = solid_.corner(t, 2);
      leaf.triangle[std::size_t(k)] = t;
      set(leaf.a, k, a);
      set(leaf.ab, k, b - a);
      set(leaf.ac, k, c - a);
      // An edge without length has one point, whatever its parameter, so any finite factor will do.
      const auto inverse = [](const Vec3& e) { return e.squaredNorm() > 0 ? 1 / e.squaredNorm() : 0.0; };
      leaf.inverse_ab[k] = inverse(b - a);
      leaf.inverse_ac[k] = inverse(c - a);
      leaf.inverse_bc[k] = inverse(c - b);
      leaf.bc_start[k] = (c - b).dot(b - a);
      const Vec3 n = (b - a).cross(c - a);
      set(leaf.to_v, k, (c - a).cross(n) * inverse(n));
      set(leaf.to_w, k, n.cross(b - a) * inverse(n));
    }
    arrays.leaves.push_back(leaf);
    return ~std::int32_t(arrays.leaves.size() - 1);
  }

  Parts parts_of(Part part, int& count) const {
    Parts parts{part};
    count = 1;
    while (count < width) {  // the largest part is split again
      Part& largest = *std::max_element(parts.begin(), parts.begin() + count,
                                        [](const Part& l, const Part& r) { return l.size() < r.size(); });
      if (largest.size() <= std::size_t(width)) break;
      std::tie(largest, parts[std::size_t(count++)]) = split(largest);
    }
    return parts;
  }

  void describe(Part own, int lane, Node& node, Dipoles& dipoles) const {
    const Bounds box = box_of(own);
    set(node.lower, lane, box.lower);
    set(node.upper, lane, box.upper);
    summarise(own, lane, dipoles);
  }

  std::int32_t add_node(Part part, Arrays& arrays) const {
    const std::size_t index = arrays.nodes.size();
    arrays.nodes.emplace_back();
    arrays.dipoles.emplace_back();
    int count = 0;
    const Parts parts = parts_of(part, count);
    Node node;
    Dipoles dipoles;
    for (int k = 0; k < width; ++k) {
      const Part own = k < count ? parts[std::size_t(k)] : Part();
      describe(own, k, node, dipoles);
      node.child[std::size_t(k)] = own.empty()                        ? 0
                                   : own.size() <= std::size_t(width) ? add_leaf(own, arrays)
                                                                      : add_node(own, arrays);
    }
    arrays.nodes[index] = node;
    arrays.dipoles[index] = dipoles;
    return std::int32_t(index);
  }

  // Computes the leading term of Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for soups and clouds,
  // 2018, section 3.
  void summarise(Part part, int lane, Dipoles& dipoles) const {
    Vec3 sum = Vec3::Zero(), area = Vec3::Zero();
    double weight = 0;
    for (const std::int32_t t : part) {
      const Vec3 own =
          0.5 * (solid_.corner(t, 1) - solid_.corner(t, 0)).cross(solid_.corner(t, 2) - solid_.corner(t, 0));
      area += own;
      sum += own.norm() * centroids_.row(t).transpose();
      weight += own.norm();
    }
    const Vec3 center = weight > 0 ? Vec3(sum / weight) : solid_.bounds_.center();
    double radius = 0;
    for (const std::int32_t t : part)
      for (int k = 0; k < 3; ++k) radius = std::max(radius, (solid_.corner(t, k) - center).norm());
    set(dipoles.center, lane, center);
    set(dipoles.area, lane, area);
    dipoles.radius[lane] = radius;
  }

  TriangleSolid& solid_;
  std::vector<std::int32_t> order_;
  Positions centroids_;
};

TriangleSolid::TriangleSolid(TriMesh surface) : surface_(std::move(surface)), bounds_(bounds_of(surface_.points)) {
  SUPPLE_CHECK(surface_.triangles.rows(), >, 0);
  // Both ends of (p - t) carry the round-off of the coordinates; at 1e-11 of their size, its direction keeps four good
  // digits.
  on_surface_ = 1e-11 * std::max(bounds_.lower.cwiseAbs().maxCoeff(), bounds_.upper.cwiseAbs().maxCoeff());
  close_holes();
  normals_.resize(surface_.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < normals_.rows(); ++t) {
    const Vec3 n = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    const double length = n.stableNorm();
    normals_.row(t) = length > 0 ? Eigen::RowVector3d((n / length).transpose()) : Eigen::RowVector3d::UnitY();
  }
  Builder(*this).build();
  prepare_sides();
}

// Any single apex will do: open edges form closed lines, so that the other sides of these triangles cancel.
void TriangleSolid::close_holes() {
  const auto open = open_edges(surface_.triangles);
  Vec3 apex = Vec3::Zero();
  for (const auto& [from, to] : open) apex += surface_.points.row(from).transpose() / double(open.size());
  for (const auto& [from, to] : open) lids_.push_back({surface_.points.row(to), surface_.points.row(from), apex});
}

// Follows Ericson, Real-Time Collision Detection, 2005, section 5.1.5, for four triangles at once. Instead of choosing
// a region first, it tries all three edges and, where it lies within, the foot on the plane: every candidate is a point
// of the triangle, so that round-off in a sliver's plane can't make it look nearer than it is.
void TriangleSolid::nearest_in_leaf(const Vec3& p, std::int32_t index, Nearest& best) const {
  const Leaf& leaf = leaves_[std::size_t(index)];
  const Lanes3 ap{p.x() - leaf.a.x, p.y() - leaf.a.y, p.z() - leaf.a.z};
  const auto offset = [&](const Lanes& s, const Lanes& t) {
    return Lanes3{ap.x - s * leaf.ab.x - t * leaf.ac.x, ap.y - s * leaf.ab.y - t * leaf.ac.y,
                  ap.z - s * leaf.ab.z - t * leaf.ac.z};
  };
  const auto squared_length = [](const Lanes3& d) { return dot(d, d); };
  const Lanes d1 = dot(leaf.ab, ap), d2 = dot(leaf.ac, ap), along_bc = d2 - d1 - leaf.bc_start;

  Lanes v = (d1 * leaf.inverse_ab).max(0).min(1), w = Lanes::Zero();
  Lanes squared = squared_length(offset(v, w));
  const auto consider = [&](const Lanes& s, const Lanes& t, const Lanes& other, const auto& better) {
    v = better.select(s, v);
    w = better.select(t, w);
    squared = better.select(other, squared);
  };
  const auto consider_edge = [&](const Lanes& s, const Lanes& t) {
    const Lanes other = squared_length(offset(s, t));
    consider(s, t, other, (other < squared).eval());
  };
  consider_edge(Lanes::Zero(), (d2 * leaf.inverse_ac).max(0).min(1));
  const Lanes of_c = (along_bc * leaf.inverse_bc).max(0).min(1);
  consider_edge(1 - of_c, of_c);
  // The foot on the plane is corrected once for what round-off left, which in slivers is much.
  Lanes s = dot(leaf.to_v, ap), t = dot(leaf.to_w, ap);
  const Lanes3 rest = offset(s, t);
  s += dot(leaf.to_v, rest);
  t += dot(leaf.to_w, rest);
  const Lanes other = squared_length(offset(s, t));
  consider(s, t, other, (other < squared && s >= 0 && t >= 0 && s + t <= 1).eval());

  for (int k = 0; k < leaf.count; ++k)
    if (squared[k] < best.squared) best = {squared[k], index, k, v[k], w[k]};
}

// Searches by branch and bound, the nearer child first. A leaf that is likely to be near saves most of the search.
// most: only triangles nearer than this are found.
TriangleSolid::Nearest TriangleSolid::nearest(const Vec3& p, std::int32_t likely, double most) const {
  struct Entry {
    double squared;
    std::int32_t node;
  };
  std::array<Entry, stack_size> stack;
  int top = 0;
  stack[std::size_t(top++)] = {0, 0};
  Nearest best{most * most, most < infinity ? -1 : 0, 0, 0, 0};
  if (likely >= 0) nearest_in_leaf(p, likely, best);
  while (top > 0) {
    const Entry entry = stack[std::size_t(--top)];
    if (!(entry.squared < best.squared)) continue;
    if (entry.node < 0) {
      nearest_in_leaf(p, ~entry.node, best);
      continue;
    }
    const Node& node = nodes_[std::size_t(entry.node)];
    const Lanes x = (node.lower.x - p.x()).max(p.x() - node.upper.x).max(0);
    const Lanes y = (node.lower.y - p.y()).max(p.y() - node.upper.y).max(0);
    const Lanes z = (node.lower.z - p.z()).max(p.z() - node.upper.z).max(0);
    const Lanes squared = x * x + y * y + z * z;
    const int first = top;
    for (int k = 0; k < width; ++k) {
      if (!(squared[k] < best.squared)) continue;
      int place = top++;  // keeps the furthest child lowest on the stack
      for (; place > first && stack[std::size_t(place - 1)].squared < squared[k]; --place)
        stack[std::size_t(place)] = stack[std::size_t(place - 1)];
      stack[std::size_t(place)] = {squared[k], node.child[std::size_t(k)]};
    }
  }
  return best;
}

SurfacePoint TriangleSolid::closest(const Vec3& p) const {
  // Seen from very far away, all points of the surface are equally distant up to round-off, and squares overflow, so
  // the query starts from a nearer point.
  const Vec3 from_center = p - bounds_.center();
  const double far = 1e12 * (bounds_.diagonal() + on_surface_), away = from_center.cwiseAbs().maxCoeff();
  const Nearest found = nearest(away > far ? Vec3(bounds_.center() + from_center / away * far) : p, -1, infinity);
  return seen_from(p, found, inside(p) ? -1 : 1);
}

SurfacePoint TriangleSolid::closest(const Vec3& p, std::int32_t& near) const {
  const bool usual = sides_by_normals_ && (p - bounds_.center()).cwiseAbs().maxCoeff() <= 1e3 * bounds_.diagonal();
  if (!usual) return closest(p);
  const Nearest found = nearest(p, near, infinity);
  near = found.leaf;
  return seen_from(p, found, side_of(p, found));
}

double TriangleSolid::distance_within(const Vec3& p, double most) const {
  const Nearest found = nearest(p, -1, 1.001 * most + 1e3 * on_surface_);
  if (found.leaf < 0) return closest(p).distance;
  const double side = sides_by_normals_ ? side_of(p, found) : inside(p) ? -1 : 1;
  return seen_from(p, found, side).distance;
}

Vec3 TriangleSolid::point_of(const Nearest& found) const {
  const Leaf& leaf = leaves_[std::size_t(found.leaf)];
  return get(leaf.a, found.lane) + found.v * get(leaf.ab, found.lane) + found.w * get(leaf.ac, found.lane);
}

SurfacePoint TriangleSolid::seen_from(const Vec3& p, const Nearest& found, double sign) const {
  const Vec3 point = point_of(found), offset = p - point;
  const double largest = offset.cwiseAbs().maxCoeff();
  if (largest <= on_surface_) return {point, normals_.row(triangle_of(found)), sign * offset.norm()};
  const Vec3 direction = offset / largest;  // its square neither overflows nor vanishes
  const double length = direction.norm();
  return {point, sign / length * direction, sign * length * largest};
}

}  // namespace supple
