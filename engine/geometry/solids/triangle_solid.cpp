#include "geometry/solids/triangle_solid.h"

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
#include "geometry/triangles/surface_thickness.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

template <class L>
void set(L& lanes, int k, const Vec3& value) {
  lanes.x[k] = value.x();
  lanes.y[k] = value.y();
  lanes.z[k] = value.z();
}

double half_area(const Bounds& box) {
  const Vec3 e = box.extent();
  return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
}

// Returns the edges, in the direction of their triangle, that no neighbour runs through in the other direction.
std::vector<std::pair<std::int32_t, std::int32_t>> open_edges(const Triangles& triangles) {
  const std::vector<TriangleEdge> edges = sorted_edges(triangles);
  std::vector<std::pair<std::int32_t, std::int32_t>> open;
  for (std::size_t i = 0; i < edges.size();) {
    const TriangleEdge edge = edges[i];
    int turns = 0;
    for (; i < edges.size() && edges[i].low == edge.low && edges[i].high == edge.high; ++i)
      turns += edges[i].upward ? 1 : -1;
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
  explicit Builder(TriangleSolid& solid)
      : solid_(solid), order_(std::size_t(solid.surface_.triangles.rows())), keys_(order_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    triangles_.reserve(order_.size());
    for (Eigen::Index t = 0; t < solid.surface_.triangles.rows(); ++t) {
      const Corners corners = solid.corners(t);
      const Vec3 area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      Bounds box;
      for (const Vec3& corner : corners) box.include(corner);
      triangles_.push_back({(corners[0] + corners[1] + corners[2]) / 3, area, area.norm(), box});
    }
    solid_.leaves_.resize((order_.size() + width - 1) / width);
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
      if (own.size() <= std::size_t(width)) return;
      made[std::size_t(k)].reserve(own.size() / 8);
      add_node(own, made[std::size_t(k)]);
    });
    Arrays all;
    all.reserve(order_.size() / 8 + 1);
    all.nodes.emplace_back();
    all.dipoles.emplace_back();
    Node root;
    Dipoles dipoles;
    for (int k = 0; k < width; ++k) {
      const Part own = k < count ? parts[std::size_t(k)] : Part();
      describe(own, k, root, dipoles);
      root.child[std::size_t(k)] = own.empty()                        ? 0
                                   : own.size() <= std::size_t(width) ? set_leaf(own)
                                                                      : append(made[std::size_t(k)], all);
    }
    all.nodes[0] = root;
    all.dipoles[0] = dipoles;
    solid_.nodes_ = std::move(all.nodes);
    solid_.dipoles_ = std::move(all.dipoles);
  }

 private:
  using Part = std::span<std::int32_t>;
  using Parts = std::array<Part, width>;

  struct Arrays {
    std::vector<Node> nodes;
    std::vector<Dipoles> dipoles;
    void reserve(std::size_t count) {
      nodes.reserve(count);
      dipoles.reserve(count);
    }
  };

  struct Triangle {
    Vec3 centroid;  // [m]
    Vec3 area;      // its vector [m^2]
    double size;    // the vector's length
    Bounds box;
  };

  // Puts a subtree behind what there is. Returns the place of its root.
  static std::int32_t append(const Arrays& subtree, Arrays& all) {
    const auto first_node = std::int32_t(all.nodes.size());
    all.nodes.insert(all.nodes.end(), subtree.nodes.begin(), subtree.nodes.end());
    all.dipoles.insert(all.dipoles.end(), subtree.dipoles.begin(), subtree.dipoles.end());
    for (std::size_t n = std::size_t(first_node); n < all.nodes.size(); ++n)
      for (std::int32_t& child : all.nodes[n].child)  // 0: there is none; below 0: a leaf
        child = child > 0 ? child + first_node : child;
    return first_node;
  }

  Bounds box_of(Part part) const {
    Bounds box;
    for (const std::int32_t t : part) {
      const Bounds& own = triangles_[std::size_t(t)].box;
      box.lower = box.lower.cwiseMin(own.lower);
      box.upper = box.upper.cwiseMax(own.upper);
    }
    return box;
  }

  std::size_t place_of(Part part) const { return std::size_t(part.data() - order_.data()); }

  // The keys lie next to each other, which takes less time than to look up each.
  void divide(Part part, std::size_t middle, int axis) {
    const std::span keys(keys_.data() + place_of(part), part.size());
    for (std::size_t i = 0; i < part.size(); ++i) keys[i] = {triangles_[std::size_t(part[i])].centroid[axis], part[i]};
    std::nth_element(keys.begin(), keys.begin() + std::ptrdiff_t(middle), keys.end());
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = keys[i].second;
  }

  std::pair<Part, Part> split(Part part) {
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

  // All parts begin at a multiple of the width, so that their places in the order tell those of the leaves.
  std::int32_t set_leaf(Part part) const {
    const std::size_t place = place_of(part) / std::size_t(width);
    Leaf& leaf = solid_.leaves_[place];
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
    return ~std::int32_t(place);
  }

  Parts parts_of(Part part, int& count) {
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

  std::int32_t add_node(Part part, Arrays& arrays) {
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
                                   : own.size() <= std::size_t(width) ? set_leaf(own)
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
      const Triangle& own = triangles_[std::size_t(t)];
      area += own.area;
      sum += own.size * own.centroid;
      weight += own.size;
    }
    const Vec3 center = weight > 0 ? Vec3(sum / weight) : solid_.bounds_.center();
    double squared = 0;
    for (const std::int32_t t : part)
      for (int k = 0; k < 3; ++k) squared = std::max(squared, (solid_.corner(t, k) - center).squaredNorm());
    const double radius = std::sqrt(squared);
    set(dipoles.center, lane, center);
    set(dipoles.area, lane, area);
    dipoles.radius[lane] = radius;
  }

  TriangleSolid& solid_;
  std::vector<std::int32_t> order_;
  std::vector<std::pair<double, std::int32_t>> keys_;  // scratch
  std::vector<Triangle> triangles_;
};

TriangleSolid::TriangleSolid(TriMesh surface) : surface_(std::move(surface)), bounds_(bounds_of(surface_.points)) {
  SUPPLE_CHECK(surface_.triangles.rows(), >, 0);
  // Both ends of (p - t) carry the round-off of the coordinates; at 1e-11 of their size, its direction keeps four good
  // digits.
  on_surface_ = 1e-11 * std::max(bounds_.lower.cwiseAbs().maxCoeff(), bounds_.upper.cwiseAbs().maxCoeff());
  certainty_ = 1e-7 * bounds_.diagonal() + on_surface_;
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

double TriangleSolid::usual_half_thickness() const {
  constexpr int places = 500;
  std::call_once(measured_->once, [this] {
    if (!is_closed()) return;
    const std::vector<ThicknessSample> samples = sampled_thickness(surface_, places);
    if (!samples.empty()) measured_->usual_half_thickness = 0.5 * samples[samples.size() / 20].thickness;
  });
  return measured_->usual_half_thickness;
}

}  // namespace supple
