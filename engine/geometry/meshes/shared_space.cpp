#include "geometry/meshes/shared_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

namespace supple {
namespace {

using CornerPlaces = std::array<Vec3, 3>;

struct Boxed {
  Vec3 lower, upper;    // [m]
  CornerPlaces corner;  // of a triangle [m]
};

bool apart(const Vec3& lower_a, const Vec3& upper_a, const Vec3& lower_b, const Vec3& upper_b) {
  return (lower_a.array() > upper_b.array()).any() || (lower_b.array() > upper_a.array()).any();
}

bool apart(const Bounds& a, const Bounds& b) { return apart(a.lower, a.upper, b.lower, b.upper); }

std::vector<Boxed> triangles_near(const Positions& points, const Triangles& triangles, const Bounds& box) {
  std::vector<Boxed> list;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    Boxed one;
    for (int k = 0; k < 3; ++k) one.corner[k] = points.row(triangles(t, k)).transpose();
    one.lower = one.corner[0].cwiseMin(one.corner[1]).cwiseMin(one.corner[2]);
    one.upper = one.corner[0].cwiseMax(one.corner[1]).cwiseMax(one.corner[2]);
    if (!apart(one.lower, one.upper, box.lower, box.upper)) list.push_back(one);
  }
  return list;
}

// Tells whether an edge passes through a triangle, away from its ends and from the triangle's border.
bool pierces(const Vec3& p, const Vec3& q, const CornerPlaces& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]), way = q - p;
  if (!(normal.dot(p - t[0]) * normal.dot(q - t[0]) < 0)) return false;
  const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double ab = way.dot(a.cross(b)), bc = way.dot(b.cross(c)), ca = way.dot(c.cross(a));
  return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

bool cross(const Boxed& a, const Boxed& b) {
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (pierces(a.corner[k], a.corner[next], b.corner) || pierces(b.corner[k], b.corner[next], a.corner)) return true;
  }
  return false;
}

Bounds box_around(std::span<const Boxed> list) {
  Bounds box;
  for (const Boxed& one : list) {
    box.include(one.lower);
    box.include(one.upper);
  }
  return box;
}

// Moves the triangles that meet a box to the front of the list, and returns them.
std::span<Boxed> those_near(std::span<Boxed> list, const Bounds& box) {
  const auto end = std::partition(list.begin(), list.end(), [&box](const Boxed& one) {
    return !apart(one.lower, one.upper, box.lower, box.upper);
  });
  return list.first(std::size_t(end - list.begin()));
}

// Tells whether any triangle of one list crosses one of the other. Both lists lose what is not near the other, and the
// longer one is halved, until few pairs are left. The order of both changes.
bool any_cross(std::span<Boxed> a, std::span<Boxed> b) {
  constexpr std::size_t few_pairs = 64;
  a = those_near(a, box_around(b));
  b = those_near(b, box_around(a));
  if (a.empty() || b.empty()) return false;
  if (a.size() < b.size()) std::swap(a, b);
  if (a.size() * b.size() <= few_pairs) {
    return std::ranges::any_of(a, [&b](const Boxed& one) {
      return std::ranges::any_of(b, [&one](const Boxed& other) {
        return !apart(one.lower, one.upper, other.lower, other.upper) && cross(one, other);
      });
    });
  }
  int axis = 0;
  box_around(a).extent().maxCoeff(&axis);
  const std::size_t half = a.size() / 2;
  std::nth_element(a.begin(), a.begin() + std::ptrdiff_t(half), a.end(), [axis](const Boxed& one, const Boxed& other) {
    return one.lower[axis] + one.upper[axis] < other.lower[axis] + other.upper[axis];
  });
  return any_cross(a.first(half), b) || any_cross(a.subspan(half), b);
}

bool surfaces_cross(const PosedMesh& a, const PosedMesh& b) {
  std::vector<Boxed> of_a = triangles_near(a.points, a.surface, b.box);
  std::vector<Boxed> of_b = triangles_near(b.points, b.surface, a.box);
  return any_cross(of_a, of_b);
}

// Tells whether corners of one mesh's surface are inside elements of the other.
bool lies_inside(const PosedMesh& a, const PosedMesh& b) {
  if (b.tets.rows() == 0) return false;
  const std::vector<Boxed> near = triangles_near(a.points, a.surface, b.box);
  Positions corners(Eigen::Index(near.size()), 3);
  for (std::size_t i = 0; i < near.size(); ++i) corners.row(Eigen::Index(i)) = near[i].corner[0].transpose();
  const std::vector<char> inside = inside_elements({b.points, b.tets, {}}, corners);
  return std::ranges::find(inside, 1) != inside.end();
}

bool share_space_as_they_are(const PosedMesh& a, const PosedMesh& b) {
  return surfaces_cross(a, b) || lies_inside(a, b) || lies_inside(b, a);
}

}  // namespace

// Faces and edges of two meshes often lie in one plane, as those of boxes on one grid do; there no edge passes through
// anything but a border. So one mesh is moved by a little, in a direction that edges of meshes hardly ever have, once
// forwards and once backwards: meshes that share space do so in both places, and meshes that touch in one at most.
bool share_space(const PosedMesh& a, const PosedMesh& b) {
  constexpr double least_depth = 1e-7;  // over the size of the smaller mesh
  if (apart(a.box, b.box)) return false;
  const Vec3 little = least_depth * std::min(a.box.diagonal(), b.box.diagonal()) * Vec3(0.47, 0.61, 0.64);
  for (const double sign : {1.0, -1.0}) {
    const Positions moved = a.points.rowwise() + sign * little.transpose();
    if (!share_space_as_they_are({moved, a.surface, a.tets}, b)) return false;
  }
  return true;
}

}  // namespace supple
