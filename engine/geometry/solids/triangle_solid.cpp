#include "geometry/solids/triangle_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/error.h"
#include "geometry/triangles/surface_thickness.h"
#include "geometry/triangles/triangle_edges.h"
#include "geometry/triangles/triangle_tree.h"

namespace supple {
namespace {

template <class L>
void set(L& lanes, int k, const Vec3& value) {
  lanes.x[k] = value.x();
  lanes.y[k] = value.y();
  lanes.z[k] = value.z();
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

// Adds a node of the binary tree, and all below it. Returns its place.
std::int32_t TriangleSolid::add_node(const TriangleTree& tree, std::int32_t from) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  dipoles_.emplace_back();
  const TriangleTree::Parts parts = tree.four_parts(from);
  const TriangleTree::Node none;
  Node node;
  Dipoles dipoles;
  for (int k = 0; k < width; ++k) {
    const std::int32_t part = parts.node[std::size_t(k)];
    const bool there = k < parts.count;
    const TriangleTree::Node& own = there ? tree.nodes[std::size_t(part)] : none;
    set(node.lower, k, own.box.lower);
    set(node.upper, k, own.box.upper);
    set(dipoles.center, k, own.center);
    set(dipoles.area, k, own.area);
    dipoles.radius[k] = own.radius;
    node.child[std::size_t(k)] = !there ? 0 : own.is_leaf() ? ~(own.first / std::int32_t(width)) : add_node(tree, part);
  }
  nodes_[index] = node;
  dipoles_[index] = dipoles;
  return std::int32_t(index);
}

TriangleSolid::Leaf TriangleSolid::leaf_of(std::span<const std::int32_t> triangles) const {
  Leaf leaf;
  leaf.count = int(triangles.size());
  for (int k = 0; k < width; ++k) {
    const std::int32_t t = triangles[k < leaf.count ? std::size_t(k) : 0];
    const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
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
  return leaf;
}

void TriangleSolid::build_tree() {
  static_assert(width == TriangleTree::leaf_size);
  const TriangleTree tree = triangle_tree(surface_, TreeCut::smallest_boxes);
  nodes_.reserve(tree.order.size() / 8 + 1);
  dipoles_.reserve(tree.order.size() / 8 + 1);
  add_node(tree, 0);
  // All leaves but the last are full, so that a leaf's first triangle tells its place.
  const std::span<const std::int32_t> order(tree.order);
  leaves_.reserve((order.size() + width - 1) / width);
  for (std::size_t first = 0; first < order.size(); first += width)
    leaves_.push_back(leaf_of(order.subspan(first, std::min<std::size_t>(width, order.size() - first))));
}

TriangleSolid::TriangleSolid(TriMesh surface) : surface_(std::move(surface)) {
  SUPPLE_CHECK(surface_.triangles.rows(), >, 0);
  measure_size();
  close_holes();
  find_normals();
  build_tree();
  prepare_sides();
}

void TriangleSolid::measure_size() {
  bounds_ = bounds_of(surface_.points);
  // Both ends of (p - t) carry the round-off of the coordinates; at 1e-11 of their size, its direction keeps four good
  // digits.
  on_surface_ = 1e-11 * std::max(bounds_.lower.cwiseAbs().maxCoeff(), bounds_.upper.cwiseAbs().maxCoeff());
  certainty_ = 1e-7 * bounds_.diagonal() + on_surface_;
}

void TriangleSolid::find_normals() {
  normals_.resize(surface_.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < normals_.rows(); ++t) {
    const Vec3 n = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    const double length = n.stableNorm();
    normals_.row(t) = length > 0 ? Eigen::RowVector3d((n / length).transpose()) : Eigen::RowVector3d::UnitY();
  }
}

// Closes holes by triangles from the open edges to one apex. Any apex will do: open edges form closed lines, so that
// the other sides of these triangles cancel.
void TriangleSolid::close_holes() {
  lids_.clear();
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
