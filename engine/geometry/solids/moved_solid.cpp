// Makes the solid of a surface whose vertices have moved. The search tree keeps its parts, and gets new boxes: a
// deformation keeps neighbours together, so that the boxes stay small.
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "base/error.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {

// Describes what a node of the tree holds, as TriangleTree::Node does.
struct TriangleSolid::Extent {
  Bounds box;
  Vec3 center = Vec3::Zero(), area = Vec3::Zero();
  double weight = 0;  // sum of the triangles' areas [m^2]
  double radius = 0;  // a bound above the distance from the centre to the furthest corner [m]
};

TriangleSolid::Extent TriangleSolid::extent_of(const Leaf& leaf) const {
  Extent extent;
  for (int k = 0; k < leaf.count; ++k) {
    const Corners own = corners(leaf.triangle[std::size_t(k)]);
    const Vec3 area = 0.5 * (own[1] - own[0]).cross(own[2] - own[0]);
    for (const Vec3& corner : own) extent.box.include(corner);
    extent.area += area;
    extent.weight += area.norm();
    extent.center += area.norm() / 3 * (own[0] + own[1] + own[2]);
  }
  extent.center = extent.weight > 0 ? Vec3(extent.center / extent.weight) : extent.box.center();
  for (int k = 0; k < leaf.count; ++k)
    for (const Vec3& corner : corners(leaf.triangle[std::size_t(k)]))
      extent.radius = std::max(extent.radius, (corner - extent.center).norm());
  return extent;
}

// Computes leaves, boxes and dipoles from the places of the vertices. Children have higher numbers than their node, so
// that what they hold is known before it.
void TriangleSolid::refit() {
  for (Leaf& leaf : leaves_) leaf = leaf_of({leaf.triangle.data(), std::size_t(leaf.count)});
  std::vector<Extent> extents(nodes_.size());
  const auto set = [](auto& lanes, int k, const Vec3& value) {
    lanes.x[k] = value.x();
    lanes.y[k] = value.y();
    lanes.z[k] = value.z();
  };
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    Dipoles& dipoles = dipoles_[i];
    Extent whole;
    std::array<Extent, width> children;
    int count = 0;
    for (int k = 0; k < width; ++k) {
      if (node.lower.x[k] > node.upper.x[k]) continue;  // there is no child here
      const std::int32_t child = node.child[std::size_t(k)];
      const Extent own = child < 0 ? extent_of(leaves_[std::size_t(~child)]) : extents[std::size_t(child)];
      set(node.lower, k, own.box.lower);
      set(node.upper, k, own.box.upper);
      set(dipoles.center, k, own.center);
      set(dipoles.area, k, own.area);
      dipoles.radius[k] = own.radius;
      whole.box.include(own.box.lower);
      whole.box.include(own.box.upper);
      whole.area += own.area;
      whole.weight += own.weight;
      whole.center += own.weight * own.center;
      children[std::size_t(count++)] = own;
    }
    whole.center = whole.weight > 0 ? Vec3(whole.center / whole.weight) : whole.box.center();
    for (int k = 0; k < count; ++k) {
      const Extent& child = children[std::size_t(k)];
      whole.radius = std::max(whole.radius, (child.center - whole.center).norm() + child.radius);
    }
    extents[i] = whole;
  }
}

std::shared_ptr<const TriangleSolid> TriangleSolid::moved(Positions points) const {
  SUPPLE_CHECK(points.rows(), ==, surface_.points.rows());
  usual_half_thickness();  // all solids of one motion share the value, which must not depend on who asks first
  const std::shared_ptr<TriangleSolid> result(new TriangleSolid(*this));
  result->surface_.points = std::move(points);
  result->measure_size();
  if (!lids_.empty()) result->close_holes();
  result->find_normals();
  result->refit();
  result->sides_by_normals_ = false;
  if (has_neighbours_) result->decide_sides();
  return result;
}

}  // namespace supple
