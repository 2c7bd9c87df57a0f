// Defines how a MovingSurface that is a sheet finds the triangles that may meet each other.
#include <algorithm>
#include <utility>

#include "base/disjoint_sets.h"
#include "geometry/triangles/moving_boxes.h"
#include "geometry/triangles/moving_surface.h"

namespace supple {
namespace {

// Tells whether two ascending lists have a number in common.
bool share_one(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (a[i] == b[k]) return true;
    ++(a[i] < b[k] ? i : k);
  }
  return false;
}

Bounds both(const Bounds& a, const Bounds& b) { return {a.lower.cwiseMin(b.lower), a.upper.cwiseMax(b.upper)}; }

}  // namespace

MovingSurface::SheetParts MovingSurface::sheet_parts() const {
  SheetParts parts;
  parts.is_connected.assign(nodes_.size(), 0);
  parts.rims.resize(nodes_.size());
  std::vector<std::vector<std::int32_t>> triangles(nodes_.size());
  std::vector<std::int32_t> number(std::size_t(start_.x.rows()), -1);  // by vertex: its number in the node, or -1
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int c = 0; c < node.count; ++c) {
      const std::int32_t child = node.child[std::size_t(c)];
      if (child < 0) {
        triangles[n].push_back(~child);
      } else {
        triangles[n].insert(triangles[n].end(), triangles[std::size_t(child)].begin(),
                            triangles[std::size_t(child)].end());
      }
    }
    std::vector<std::int32_t> vertices;
    std::vector<std::size_t> triangles_at;
    DisjointSets pieces(3 * triangles[n].size());
    for (const std::int32_t t : triangles[n]) {
      std::array<std::size_t, 3> own{};
      for (int k = 0; k < 3; ++k) {
        std::int32_t& known = number[std::size_t(triangles_(t, k))];
        if (known < 0) {
          known = std::int32_t(vertices.size());
          vertices.push_back(triangles_(t, k));
          triangles_at.push_back(0);
        }
        own[std::size_t(k)] = std::size_t(known);
        ++triangles_at[std::size_t(known)];
      }
      pieces.join(own[0], own[1]);
      pieces.join(own[0], own[2]);
    }
    bool is_connected = true;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      is_connected &= pieces.of(i) == 0;
      number[std::size_t(vertices[i])] = -1;
      if (triangles_at[i] < around(vertices[i]).size()) parts.rims[n].push_back(vertices[i]);
    }
    std::ranges::sort(parts.rims[n]);
    parts.is_connected[n] = is_connected ? 1 : 0;
  }
  return parts;
}

// Walks down the tree through pairs of nodes, and leaves out those of which no triangles can meet.
struct MovingSurface::SheetSearch {
  using Lanes = Boxes::Lanes;
  using Mask = Eigen::Array<bool, width, 1>;

  const MovingSurface& surface;
  const SheetParts& parts;
  double margin;  // the query's margin, and what round-off may add to it [m]
  Vec3 carried;
  const VisitTriangles& visit;

  static Bounds lane(const Boxes& all, int c) {
    return {Vec3(all.lower[0][c], all.lower[1][c], all.lower[2][c]),
            Vec3(all.upper[0][c], all.upper[1][c], all.upper[2][c])};
  }

  // Returns the box in which a node's child moves.
  Bounds swept(std::size_t node, int c) const {
    const Bounds start = lane(surface.start_.boxes[node], c), end = lane(surface.end_.boxes[node], c);
    return {start.lower.cwiseMin(end.lower - carried), start.upper.cwiseMax(end.upper - carried)};
  }

  // Returns a box around the normals, at both times, of what a node's child or the whole node holds.
  Bounds facing(std::size_t node, int c) const {
    return both(lane(parts.start.normals[node], c), lane(parts.end.normals[node], c));
  }
  Bounds facing(std::size_t node) const {
    return both(whole_box(parts.start.normals[node]), whole_box(parts.end.normals[node]));
  }

  // Tells which of a node's children come near a box.
  Mask near(std::size_t node, const Bounds& box) const {
    return gaps(surface.start_.boxes[node], surface.end_.boxes[node], carried, box) <= margin;
  }

  // Tells for which of a node's children there is a direction that is within some 75 degrees of all of the child's
  // normals and of those in a box.
  Mask alike(std::size_t node, const Bounds& box) const {
    constexpr double least_cosine = 0.25;
    const Boxes &start = parts.start.normals[node], &end = parts.end.normals[node];
    Lanes least = Lanes::Zero(), length = Lanes::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes low = start.lower[k].min(end.lower[k]).min(box.lower[int(k)]),
                  high = start.upper[k].max(end.upper[k]).max(box.upper[int(k)]), middle = 0.5 * (low + high);
      least += (middle * low).min(middle * high);
      length += middle.square();
    }
    return least > 0 && least.square() > least_cosine * least_cosine * length;
  }

  bool are_linked(std::int32_t a, std::int32_t b) const {
    const auto one = std::size_t(a), other = std::size_t(b);
    return parts.is_connected[one] != 0 && parts.is_connected[other] != 0 &&
           share_one(parts.rims[one], parts.rims[other]);
  }

  using Waiting = std::vector<std::array<std::int32_t, 2>>;

  // Pairs a node, or the triangle of which `one` is the complement, with the children of another node from number
  // `first` on. Two triangles that may come near are visited, and two nodes of which triangles can meet are put in
  // `waiting`. box, normals: those of `one`. Tells whether a visit returned true.
  bool any_with(std::int32_t one, const Bounds& box, const Bounds& normals, std::int32_t node, int first,
                Waiting& waiting) const {
    const auto n = std::size_t(node);
    const Node& other = surface.nodes_[n];
    const Mask is_near = near(n, box);
    if (!is_near.any()) return false;
    if (one < 0) {
      for (int d = first; d < other.count; ++d)
        if (is_near[d] && visit(~one, ~other.child[std::size_t(d)])) return true;
      return false;
    }
    const Mask is_alike = alike(n, normals);
    for (int d = first; d < other.count; ++d) {
      const std::int32_t child = other.child[std::size_t(d)];
      if (is_near[d] && !(is_alike[d] && are_linked(one, child))) waiting.push_back({one, child});
    }
    return false;
  }

  bool any_within(std::int32_t a, Waiting& waiting) const {
    const auto n = std::size_t(a);
    const Node& node = surface.nodes_[n];
    for (int c = 0; c < node.count; ++c) {
      const std::int32_t child = node.child[std::size_t(c)];
      const Bounds normals = facing(n, c);
      if (child >= 0 && !(parts.is_connected[std::size_t(child)] != 0 && alike(n, normals)[c]))
        waiting.push_back({child, child});
      if (any_with(child, swept(n, c), normals, a, c + 1, waiting)) return true;
    }
    return false;
  }

  bool any_between(std::int32_t a, std::int32_t b, Waiting& waiting) const {
    const auto one = std::size_t(a), other = std::size_t(b);
    const bool is_leaf = surface.nodes_[one].is_leaf(), other_is_leaf = surface.nodes_[other].is_leaf();
    if (is_leaf && !other_is_leaf) return any_with(a, surface.swept_box(a, carried), facing(one), b, 0, waiting);
    if (!is_leaf && other_is_leaf) return any_with(b, surface.swept_box(b, carried), facing(other), a, 0, waiting);
    for (int c = 0; c < surface.nodes_[one].count; ++c)
      if (any_with(surface.nodes_[one].child[std::size_t(c)], swept(one, c), facing(one, c), b, 0, waiting))
        return true;
    return false;
  }

  bool any() const {
    if (parts.is_connected[0] != 0 && is_flat()) return false;
    Waiting waiting = {{0, 0}};
    while (!waiting.empty()) {
      const auto [a, b] = waiting.back();
      waiting.pop_back();
      if (a == b ? any_within(a, waiting) : any_between(a, b, waiting)) return true;
    }
    return false;
  }

  bool is_flat() const {
    const Bounds all = facing(0);
    return alike(0, all).head(surface.nodes_[0].count).all();
  }
};

// Returns the corners of a leaf's triangles; lanes without a triangle have those of the first one.
MovingSurface::Corners MovingSurface::corners(const Positions& x, const Node& leaf) const {
  Corners corner;
  for (int c = 0; c < width; ++c) {
    const std::int32_t t = ~leaf.child[std::size_t(c < leaf.count ? c : 0)];
    for (std::size_t k = 0; k < 3; ++k) {
      const double* place = x.row(triangles_(t, int(k))).data();
      for (std::size_t axis = 0; axis < 3; ++axis) corner[k][axis][c] = place[axis];
    }
  }
  return corner;
}

// Returns the unit normals of triangles, by axis; zero for those without area.
std::array<MovingSurface::Boxes::Lanes, 3> MovingSurface::unit_normals(const Corners& corner) {
  using Lanes = Boxes::Lanes;
  std::array<Lanes, 3> one, other;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    one[axis] = corner[1][axis] - corner[0][axis];
    other[axis] = corner[2][axis] - corner[0][axis];
  }
  std::array<Lanes, 3> normal = {one[1] * other[2] - one[2] * other[1], one[2] * other[0] - one[0] * other[2],
                                 one[0] * other[1] - one[1] * other[0]};
  const Lanes squared = normal[0].square() + normal[1].square() + normal[2].square();
  const Lanes share = (squared > 0).select(squared.rsqrt(), Lanes::Zero());
  for (Lanes& axis : normal) axis *= share;
  return normal;
}

// Finds boxes around the unit normals of what each node's children hold at one time, unless they are known already.
void MovingSurface::find_normals(const Pose& pose, SheetParts::Normals& of) const {
  if (std::exchange(of.pose, pose.number) == pose.number) return;
  std::vector<Boxes>& normals = of.normals;
  normals.resize(nodes_.size());
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    if (node.is_leaf()) {
      normals[n].lower = normals[n].upper = unit_normals(corners(pose.x, node));
      continue;
    }
    for (int c = 0; c < width; ++c) {
      const Bounds box = whole_box(normals[std::size_t(node.child[std::size_t(c < node.count ? c : 0)])]);
      for (std::size_t k = 0; k < 3; ++k) {
        normals[n].lower[k][c] = box.lower[int(k)];
        normals[n].upper[k][c] = box.upper[int(k)];
      }
    }
  }
}

bool MovingSurface::any_own_triangles(SheetParts& parts, double margin, const Vec3& carried,
                                      const VisitTriangles& visit) const {
  const Bounds box = swept_box(0, carried);
  const double reach = margin + roundoff_at(box.lower, box.upper) + 2 * roundoff_at(carried, carried);
  if (parts.start.pose != start_.number) std::swap(parts.start, parts.end);
  find_normals(start_, parts.start);
  find_normals(end_, parts.end);
  return SheetSearch{*this, parts, reach, carried, visit}.any();
}

}  // namespace supple
