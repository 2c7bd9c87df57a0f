// Tells on which side of a solid's surface a point lies, and where a way enters the solid.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "base/threads.h"
#include "geometry/solids/triangle_solid.h"
#include "geometry/triangles/triangle_edges.h"
#include "geometry/triangles/triangle_tree.h"

namespace supple {
namespace {

// Calls ends(triangle) for all triangles of those leaves whose boxes meet a box, until it returns true. Returns whether
// it did.
template <class Node, class Leaf, class Ends>
bool any_near(const std::vector<Node>& nodes, const std::vector<Leaf>& leaves, const Vec3& lower, const Vec3& upper,
              const Ends& ends) {
  TreeStack<std::int32_t> stack(0);
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    if (index < 0) {
      const Leaf& leaf = leaves[std::size_t(~index)];
      for (int k = 0; k < leaf.count; ++k) {
        if (ends(leaf.triangle[std::size_t(k)])) return true;
      }
      continue;
    }
    const Node& node = nodes[std::size_t(index)];
    const auto met = (node.lower.x <= upper.x()) & (node.upper.x >= lower.x()) & (node.lower.y <= upper.y()) &
                     (node.upper.y >= lower.y()) & (node.lower.z <= upper.z()) & (node.upper.z >= lower.z());
    for (std::size_t k = 0; k < node.child.size(); ++k) {
      if (met[k]) stack.push(node.child[k]);
    }
  }
  return false;
}

// Computes the signed solid angle of a triangle, as seen from the origin, over 4 pi: Van Oosterom and Strackee, The
// solid angle of a plane triangle, 1983, equation 8.
double winding_of_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double y = a.dot(b.cross(c));
  const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(y, x) / (2 * std::numbers::pi);
}

// Tells whether a way from a passes through a triangle, from either side: Moeller and Trumbore, Fast, minimum storage
// ray-triangle intersection, 1997.
template <class Corners>
bool passes_through(const Vec3& a, const Vec3& way, const Corners& corners) {
  constexpr double slack = 1e-9;
  const Vec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], across = way.cross(ac);
  const double facing = ab.dot(across);
  if (facing == 0) return false;
  const Vec3 away = a - corners[0], turned = away.cross(ab);
  const double v = away.dot(across) / facing, w = way.dot(turned) / facing, share = ac.dot(turned) / facing;
  return v > slack && w > slack && v + w < 1 - slack && share > slack && share < 1 - slack;
}

}  // namespace

double TriangleSolid::winding_number(const Vec3& p) const {
  // A part counts as far beyond twice its radius, as in section 3.2 of Barill et al. 2018 (triangle_tree.h).
  constexpr double far = 2;
  // At this distance the result is below round-off, and further away squares would overflow.
  if ((p - bounds_.center()).cwiseAbs().maxCoeff() > 1e12 * (bounds_.diagonal() + on_surface_)) return 0;
  TreeStack<std::int32_t> stack(0);
  double sum = 0;
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    if (index < 0) {
      const Leaf& leaf = leaves_[std::size_t(~index)];
      for (int k = 0; k < leaf.count; ++k) {
        const Eigen::Index t = leaf.triangle[std::size_t(k)];
        sum += winding_of_triangle(corner(t, 0) - p, corner(t, 1) - p, corner(t, 2) - p);
      }
      continue;
    }
    const Node& node = nodes_[std::size_t(index)];
    const Dipoles& dipoles = dipoles_[std::size_t(index)];
    const Lanes x = dipoles.center.x - p.x(), y = dipoles.center.y - p.y(), z = dipoles.center.z - p.z();
    const Lanes squared = x * x + y * y + z * z;
    const Lanes reach = far * dipoles.radius;
    const Lanes flux = dipoles.area.x * x + dipoles.area.y * y + dipoles.area.z * z;
    for (int k = 0; k < width; ++k) {
      if (node.lower.x[k] > node.upper.x[k]) continue;  // there is no child here
      if (squared[k] > reach[k] * reach[k]) {
        sum += flux[k] / (squared[k] * std::sqrt(squared[k]) * (4 * std::numbers::pi));
      } else {
        stack.push(node.child[std::size_t(k)]);
      }
    }
  }
  return sum;
}

// Tells how the triangle meets the ray from p: +1 where the ray leaves through it, -1 where it enters, 0 where it
// passes by. Seen along the ray, the triangle's winding around p is a sum over those edges that cross the level of p on
// the far side of p. That side is computed from the edge's lower to its upper end, the same for both neighbours, so
// that round-off can't let a ray slip between two triangles or count both.
int TriangleSolid::crossing(const Vec3& p, const Corners& corners, int axis, int direction) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int turns = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3& from = corners[std::size_t(k)];
    const Vec3& to = corners[std::size_t((k + 1) % 3)];
    const bool upward = to[v] >= p[v];
    if ((from[v] >= p[v]) == upward) continue;
    const Vec3& low = upward ? from : to;
    const Vec3& high = upward ? to : from;
    bool beyond = low[u] > p[u];
    if (beyond != (high[u] > p[u]))
      beyond = (high[u] - low[u]) * (p[v] - low[v]) > (p[u] - low[u]) * (high[v] - low[v]);
    if (beyond) turns += upward ? 1 : -1;
  }
  if (turns == 0) return 0;
  const auto ahead = [&](const Vec3& q) { return direction * (q[axis] - p[axis]) > 0; };
  const int count = int(ahead(corners[0])) + int(ahead(corners[1])) + int(ahead(corners[2]));
  if (count == 0) return 0;
  if (count < 3) {
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(direction * turns * normal.dot(p - corners[0]) < 0)) return 0;
  }
  return direction * turns;
}

// Computes the winding number of a point in the box for the surface whose holes are closed by lids. It is a whole
// number: the signed crossings of the axis-parallel ray to the nearest side of the box.
int TriangleSolid::crossings(const Vec3& p) const {
  int axis = 0, direction = 1;
  double shortest = infinity;
  for (int k = 0; k < 3; ++k) {
    for (const int sign : {1, -1}) {
      const double length = sign > 0 ? bounds_.upper[k] - p[k] : p[k] - bounds_.lower[k];
      if (length < shortest) {
        shortest = length;
        axis = k;
        direction = sign;
      }
    }
  }
  Vec3 lower = p, upper = p;  // the ray's box
  (direction > 0 ? upper : lower)[axis] = direction * infinity;
  int sum = 0;
  for (const Corners& lid : lids_) sum += crossing(p, lid, axis, direction);
  any_near(nodes_, leaves_, lower, upper, [&](std::int32_t triangle) {
    sum += crossing(p, corners(triangle), axis, direction);
    return false;
  });
  return sum;
}

bool TriangleSolid::inside(const Vec3& p) const {
  if ((p.array() < bounds_.lower.array()).any() || (p.array() > bounds_.upper.array()).any()) return false;
  // Lids cost time in every query; with more than this many, the tree is faster.
  constexpr std::size_t most_lids = 32;
  if (lids_.size() > most_lids) return winding_number(p) > 0.5;
  double of_lids = 0;
  for (const Corners& lid : lids_) of_lids += winding_of_triangle(lid[0] - p, lid[1] - p, lid[2] - p);
  return crossings(p) - of_lids > 0.5;
}

// Pairs each edge with the same edge of its neighbour. Returns false when some edge has not exactly one neighbour.
bool TriangleSolid::find_neighbours() {
  const std::vector<TriangleEdge> edges = sorted_edges(surface_.triangles);
  neighbours_.resize(surface_.triangles.rows(), 3);
  const auto are_one = [](const TriangleEdge& a, const TriangleEdge& b) { return a.low == b.low && a.high == b.high; };
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const bool pair = i + 1 < edges.size() && are_one(edges[i], edges[i + 1]) && edges[i].upward != edges[i + 1].upward;
    if (!pair || (i + 2 < edges.size() && are_one(edges[i], edges[i + 2]))) return false;
    neighbours_(edges[i].triangle, edges[i].side) = edges[i + 1].triangle;
    neighbours_(edges[i + 1].triangle, edges[i + 1].side) = edges[i].triangle;
  }
  return true;
}

// Tells whether the edge between two vertices passes through a triangle that has neither of them. An edge that only
// touches a triangle does not.
bool TriangleSolid::pierced_by(std::int32_t from, std::int32_t to) const {
  const Vec3 a = surface_.points.row(from), b = surface_.points.row(to), way = b - a;
  return any_near(nodes_, leaves_, a.cwiseMin(b), a.cwiseMax(b), [&](std::int32_t triangle) {
    const auto corner_names = surface_.triangles.row(triangle);
    if ((corner_names.array() == from).any() || (corner_names.array() == to).any()) return false;
    return passes_through(a, way, corners(triangle));
  });
}

// Tells whether the surface crosses itself. Where two triangles cross each other, an edge of one of them passes through
// the other.
bool TriangleSolid::crosses_itself() const {
  constexpr Eigen::Index chunk = 4096;  // each stops at its first triangle with an edge that passes through another one
  const auto chunks = std::size_t((surface_.triangles.rows() + chunk - 1) / chunk);
  std::vector<char> crossed(chunks, 0);
  Threads threads(chunks > 1 ? int(std::max(1u, std::thread::hardware_concurrency())) : 1);
  threads.run(int(chunks), [&](int c) {
    const Eigen::Index end = std::min((c + 1) * chunk, surface_.triangles.rows());
    for (Eigen::Index t = c * chunk; t < end && !crossed[std::size_t(c)]; ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t from = surface_.triangles(t, k), to = surface_.triangles(t, (k + 1) % 3);
        crossed[std::size_t(c)] |= neighbours_(t, k) > t && pierced_by(from, to);
      }
    }
  });
  return std::find(crossed.begin(), crossed.end(), 1) != crossed.end();
}

std::vector<Eigen::Index> TriangleSolid::one_of_each_component() const {
  std::vector<Eigen::Index> firsts, waiting;
  std::vector<char> reached(std::size_t(surface_.triangles.rows()), 0);
  for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
    if (reached[std::size_t(t)]) continue;
    firsts.push_back(t);
    waiting.push_back(t);
    reached[std::size_t(t)] = 1;
    while (!waiting.empty()) {
      const Eigen::Index next = waiting.back();
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        const std::int32_t other = neighbours_(next, k);
        if (!reached[std::size_t(other)]) waiting.push_back(other);
        reached[std::size_t(other)] = 1;
      }
    }
  }
  return firsts;
}

// Prepares to find a point's side. If every edge has one neighbour, the surface does not cross itself and all parts of
// it face empty space, the side follows from the normals around its closest point alone: Baerentzen and Aanaes, Signed
// distance computation using the angle weighted pseudonormal, 2005. Overlapping parts, of which some lie inside others,
// need the winding number.
void TriangleSolid::prepare_sides() {
  has_neighbours_ = lids_.empty() && find_neighbours();
  if (has_neighbours_) decide_sides();
}

void TriangleSolid::decide_sides() {
  if (crosses_itself()) return;
  for (const Eigen::Index t : one_of_each_component()) {
    const Vec3 middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    const double edge = (corner(t, 1) - corner(t, 0)).norm();
    if (inside(middle + 1e-3 * edge * normals_.row(t).transpose())) return;
  }
  vertex_normals_.setZero(surface_.points.rows(), 3);
  for (Eigen::Index t = 0; t < surface_.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 l = corner(t, (k + 1) % 3) - corner(t, k), r = corner(t, (k + 2) % 3) - corner(t, k);
      vertex_normals_.row(surface_.triangles(t, k)) += std::atan2(l.cross(r).norm(), l.dot(r)) * normals_.row(t);
    }
  }
  sides_by_normals_ = true;
}

double TriangleSolid::side_of(const Vec3& p, const Nearest& found) const {
  constexpr double at_edge = 1e-12;
  const std::int32_t t = found.triangle;
  const double weight[3] = {1 - found.v - found.w, found.v, found.w};  // of the corners
  int zeros = 0, zero = 0, whole = 0;
  for (int k = 0; k < 3; ++k) {
    if (weight[k] <= at_edge) {
      ++zeros;
      zero = k;
    } else {
      whole = k;
    }
  }
  Eigen::RowVector3d normal = normals_.row(t);
  if (zeros == 1) normal += normals_.row(neighbours_(t, (zero + 1) % 3));
  if (zeros == 2) normal = vertex_normals_.row(surface_.triangles(t, whole));
  return normal.dot(p - point_of(found)) < 0 ? -1 : 1;
}

// Lowers `first` to the share of a way at which it enters through a triangle of a leaf, if that is less. Follows
// Moeller and Trumbore, Fast, minimum storage ray-triangle intersection, 1997, for four triangles at once. Only
// triangles that face the way count; a way that could slip between two of them by round-off meets both.
void TriangleSolid::entry_in_leaf(const Vec3& a, const Vec3& way, std::int32_t index, double& first) const {
  constexpr double slack = 1e-9;
  const Leaf& leaf = leaves_[std::size_t(index)];
  const Lanes from_x = a.x() - leaf.a.x, from_y = a.y() - leaf.a.y, from_z = a.z() - leaf.a.z;
  const Lanes across_x = way.y() * leaf.ac.z - way.z() * leaf.ac.y,
              across_y = way.z() * leaf.ac.x - way.x() * leaf.ac.z,
              across_z = way.x() * leaf.ac.y - way.y() * leaf.ac.x;
  const Lanes turned_x = from_y * leaf.ab.z - from_z * leaf.ab.y, turned_y = from_z * leaf.ab.x - from_x * leaf.ab.z,
              turned_z = from_x * leaf.ab.y - from_y * leaf.ab.x;
  const Lanes facing = leaf.ab.x * across_x + leaf.ab.y * across_y + leaf.ab.z * across_z;
  const Lanes v = (from_x * across_x + from_y * across_y + from_z * across_z) / facing;
  const Lanes w = (way.x() * turned_x + way.y() * turned_y + way.z() * turned_z) / facing;
  const Lanes share = (leaf.ac.x * turned_x + leaf.ac.y * turned_y + leaf.ac.z * turned_z) / facing;
  for (int k = 0; k < leaf.count; ++k) {
    const bool met = facing[k] > 0 && v[k] >= -slack && w[k] >= -slack && v[k] + w[k] <= 1 + slack;
    if (met && share[k] >= 0 && share[k] < first) first = share[k];
  }
}

std::optional<double> TriangleSolid::entry(const Vec3& a, const Vec3& b) const {
  const Vec3 way = b - a;
  Vec3 inverse;
  for (int k = 0; k < 3; ++k) inverse[k] = 1 / (std::abs(way[k]) > 1e-290 ? way[k] : 1e-290);
  double first = 1 + 1e-12;
  TreeStack<std::int32_t> stack(0);
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    if (index < 0) {
      entry_in_leaf(a, way, ~index, first);
      continue;
    }
    const Node& node = nodes_[std::size_t(index)];
    const Lanes zero = {};
    Lanes in = zero, out = zero + first;
    const auto slab = [&](const Lanes& lower, const Lanes& upper, int k) __attribute__((always_inline)) {
      const Lanes l = (lower - a[k]) * inverse[k], u = (upper - a[k]) * inverse[k];
      const Lanes near = l < u ? l : u, far = l < u ? u : l;
      in = near > in ? near : in;
      out = far < out ? far : out;
    };
    slab(node.lower.x, node.upper.x, 0);
    slab(node.lower.y, node.upper.y, 1);
    slab(node.lower.z, node.upper.z, 2);
    for (int k = 0; k < width; ++k) {
      if (node.lower.x[k] > node.upper.x[k]) continue;  // there is no child here
      if (in[k] <= out[k] + 1e-12) stack.push(node.child[std::size_t(k)]);
    }
  }
  return first <= 1 ? std::optional(first) : std::nullopt;
}

}  // namespace supple
