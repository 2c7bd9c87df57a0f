// Finds the closest point of a triangle solid, from scratch or with what earlier queries have found.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/solids/triangle_solid.h"
#include "geometry/triangles/triangle_tree.h"

namespace supple {
namespace {

template <class L>
Vec3 get(const L& lanes, int k) {
  return Vec3(lanes.x[k], lanes.y[k], lanes.z[k]);
}

// Returns the squared distances of p from the boxes of a node's children.
template <class Node>
[[gnu::always_inline]] inline auto squared_distances(const Node& node, const Vec3& p) {
  using Lanes = decltype(node.lower.x);
  const Lanes zero = {};
  const auto outside = [&](const Lanes& lower, const Lanes& upper, double at) __attribute__((always_inline)) {
    const Lanes below = lower - at, above = at - upper, either = below > above ? below : above;
    return Lanes(either > zero ? either : zero);
  };
  const Lanes x = outside(node.lower.x, node.upper.x, p.x()), y = outside(node.lower.y, node.upper.y, p.y()),
              z = outside(node.lower.z, node.upper.z, p.z());
  return Lanes(x * x + y * y + z * z);
}

}  // namespace

// Replaces `best` by the closest point of a leaf's triangles, if that is nearer. Follows Ericson, Real-Time Collision
// Detection, 2005, section 5.1.5, for four triangles at once. Instead of choosing a region first, it tries the closest
// points of all three edges, and the foot on the plane where the foot lies within the triangle: every candidate is a
// point of the triangle, so that round-off in a sliver's plane can't make it look nearer than it is.
void TriangleSolid::nearest_in_leaf(const Vec3& p, std::int32_t index, Nearest& best) const {
  const Leaf& leaf = leaves_[std::size_t(index)];
  const Lanes ap_x = p.x() - leaf.a.x, ap_y = p.y() - leaf.a.y, ap_z = p.z() - leaf.a.z;
  const Lanes zero = {};
  const Lanes d1 = leaf.ab.x * ap_x + leaf.ab.y * ap_y + leaf.ab.z * ap_z;
  const Lanes d2 = leaf.ac.x * ap_x + leaf.ac.y * ap_y + leaf.ac.z * ap_z;
  Lanes v = zero, w = zero, squared = zero + infinity;
  Lanes x, y, z;  // from the candidate to the point
  const auto set_offset = [&](const Lanes& s, const Lanes& t) __attribute__((always_inline)) {
    x = ap_x - s * leaf.ab.x - t * leaf.ac.x;
    y = ap_y - s * leaf.ab.y - t * leaf.ac.y;
    z = ap_z - s * leaf.ab.z - t * leaf.ac.z;
  };
  const auto consider = [&](const Lanes& s, const Lanes& t, const auto& allowed) __attribute__((always_inline)) {
    set_offset(s, t);
    const Lanes other = x * x + y * y + z * z;
    const auto better = (other < squared) & allowed;
    v = better ? s : v;
    w = better ? t : w;
    squared = better ? other : squared;
  };
  const auto clamped = [&](const Lanes& s) __attribute__((always_inline)) {
    const Lanes above = s > zero ? s : zero;
    return Lanes(above < 1.0 ? above : zero + 1.0);
  };
  const auto always = zero == zero;
  consider(clamped(d1 * leaf.inverse_ab), zero, always);
  consider(zero, clamped(d2 * leaf.inverse_ac), always);
  const Lanes of_c = clamped((d2 - d1 - leaf.bc_start) * leaf.inverse_bc);
  consider(1.0 - of_c, of_c, always);
  // The foot on the plane is corrected once for what round-off left, which in slivers is much.
  Lanes s = leaf.to_v.x * ap_x + leaf.to_v.y * ap_y + leaf.to_v.z * ap_z;
  Lanes t = leaf.to_w.x * ap_x + leaf.to_w.y * ap_y + leaf.to_w.z * ap_z;
  set_offset(s, t);
  s += leaf.to_v.x * x + leaf.to_v.y * y + leaf.to_v.z * z;
  t += leaf.to_w.x * x + leaf.to_w.y * y + leaf.to_w.z * z;
  consider(s, t, (s >= zero) & (t >= zero) & (s + t <= 1.0));

  for (int k = 0; k < leaf.count; ++k) {
    const std::int32_t triangle = leaf.triangle[std::size_t(k)];
    if (squared[k] < best.squared || (squared[k] == best.squared && triangle < best.triangle))
      best = {squared[k], index, k, triangle, v[k], w[k]};
  }
}

// Searches by branch and bound, the nearer child first. likely: a leaf that is probably near, which saves most of the
// search; -1: none. Of triangles that are equally near, the first one is taken, and boxes are left out only where they
// are further by more than round-off, so that the answer does not depend on where the search begins. most: the distance
// below which triangles are found [m].
TriangleSolid::Nearest TriangleSolid::nearest(const Vec3& p, std::int32_t likely, double most) const {
  struct Entry {
    double squared;
    std::int32_t node;
  };
  const auto is_further = [](const Entry& a, const Entry& b) { return b.squared < a.squared; };
  TreeStack<Entry> stack({0, 0});
  Nearest best{most * most, most < infinity ? -1 : 0, 0, 0, 0, 0};
  double bound = infinity;
  const auto look = [&](std::int32_t leaf) {
    const double before = best.squared;
    nearest_in_leaf(p, leaf, best);
    if (!(best.squared < before)) return;
    const double reach = (1 + 1e-14) * std::sqrt(best.squared) + on_surface_;
    bound = reach * reach;
  };
  if (most < infinity) bound = best.squared;
  if (likely >= 0) look(likely);
  while (!stack.empty()) {
    const Entry entry = stack.pop();
    if (!(entry.squared < bound)) continue;
    if (entry.node < 0) {
      if (~entry.node != likely) look(~entry.node);
      continue;
    }
    const Node& node = nodes_[std::size_t(entry.node)];
    const Lanes squared = squared_distances(node, p);
    const int first = stack.size();
    for (int k = 0; k < width; ++k)
      if (squared[k] < bound) stack.push_below(first, {squared[k], node.child[std::size_t(k)]}, is_further);
  }
  return best;
}

SurfacePlace TriangleSolid::place(const Vec3& p) const {
  const Nearest found = nearest(p, -1, infinity);
  return {found.triangle, found.v, found.w};
}

SurfacePoint TriangleSolid::closest(const Vec3& p) const {
  // Seen from very far away, all points of the surface are equally distant up to round-off, and squares overflow, so
  // the query starts from a nearer point.
  const Vec3 from_center = p - bounds_.center();
  const double far = 1e12 * (bounds_.diagonal() + on_surface_), away = from_center.cwiseAbs().maxCoeff();
  const Nearest found = nearest(away > far ? Vec3(bounds_.center() + from_center / away * far) : p, -1, infinity);
  return seen_from(p, found, inside(p) ? -1 : 1);
}

SurfacePoint TriangleSolid::closest(const Vec3& p, QueryMemory& near) const {
  return *closest_within(p, infinity, near);
}

std::optional<SurfacePoint> TriangleSolid::closest_within(const Vec3& p, double most, QueryMemory& near) const {
  for (std::int32_t i = 0; i < near.count; ++i) {
    if (near.answers[std::size_t(i)].place != p) continue;
    near.oldest = 1 - i;
    return near.answers[std::size_t(i)].surface;
  }
  const bool usual = (p - bounds_.center()).cwiseAbs().maxCoeff() <= 1e3 * bounds_.diagonal();
  if (!usual) return closest(p);
  const Nearest found = nearest(p, near.leaf, most);
  if (found.leaf < 0) return std::nullopt;
  const SurfacePoint surface = seen_from(p, found, side_at(p, found));
  near.leaf = found.leaf;
  near.answers[std::size_t(near.oldest)] = {p, surface};
  near.count = std::max(near.count, near.oldest + 1);
  near.oldest = 1 - near.oldest;
  return surface;
}

double TriangleSolid::certain_distance(const Vec3& p, const QueryMemory& near) const {
  double most = -infinity;
  if (!is_closed()) return most;
  for (std::int32_t i = 0; i < near.count; ++i) {
    const QueryMemory::Answer& answer = near.answers[std::size_t(i)];
    most = std::max(most, answer.surface.distance - (p - answer.place).norm() - certainty_);
  }
  return most;
}

bool TriangleSolid::find_leaves(const Vec3& p, double reach, NearLeaves& found) const {
  const double with_slack = 1.001 * reach + 1e3 * on_surface_, bound = with_slack * with_slack;
  TreeStack<std::int32_t> stack(0);
  found.count = 0;
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    if (index < 0) {
      if (found.count == int(found.leaf.size())) {
        found.count = 0;
        return false;
      }
      found.leaf[std::size_t(found.count++)] = ~index;
      continue;
    }
    const Node& node = nodes_[std::size_t(index)];
    const Lanes squared = squared_distances(node, p);
    for (int k = 0; k < width; ++k)
      if (squared[k] <= bound) stack.push(node.child[std::size_t(k)]);
  }
  return true;
}

double TriangleSolid::distance_among(const Vec3& p, const NearLeaves& leaves) const {
  Nearest best{infinity, -1, 0, 0, 0, 0};
  for (int i = 0; i < leaves.count; ++i) nearest_in_leaf(p, leaves.leaf[std::size_t(i)], best);
  return seen_from(p, best, side_at(p, best)).distance;
}

Vec3 TriangleSolid::point_of(const Nearest& found) const {
  const Leaf& leaf = leaves_[std::size_t(found.leaf)];
  return get(leaf.a, found.lane) + found.v * get(leaf.ab, found.lane) + found.w * get(leaf.ac, found.lane);
}

SurfacePoint TriangleSolid::seen_from(const Vec3& p, const Nearest& found, double sign) const {
  const Vec3 point = point_of(found), offset = p - point;
  const double largest = offset.cwiseAbs().maxCoeff();
  if (largest <= on_surface_) return {point, normals_.row(found.triangle), sign * offset.norm()};
  const Vec3 direction = offset / largest;  // its square neither overflows nor vanishes
  const double length = direction.norm();
  return {point, sign / length * direction, sign * length * largest};
}

}  // namespace supple
