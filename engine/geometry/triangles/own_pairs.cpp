// Defines how a MovingSurface finds the places at which it may meet itself.
#include <algorithm>

#include "base/error.h"
#include "geometry/triangles/moving_boxes.h"
#include "geometry/triangles/moving_surface.h"

namespace supple {

MovingSurface::SolidParts MovingSurface::solid_parts(const TrianglesOf& triangles_of) const {
  static_assert(3 * width * width <= 64, "a mask has a bit for each vertex of one leaf and each triangle of another");
  struct Place {
    std::int32_t leaf, lane;
  };
  std::vector<Place> place_of(std::size_t(triangles_.rows()));
  for (std::size_t n = 0; n < nodes_.size(); ++n)
    for (std::int32_t c = 0; nodes_[n].is_leaf() && c < nodes_[n].count; ++c)
      place_of[std::size_t(~nodes_[n].child[std::size_t(c)])] = {std::int32_t(n), c};
  struct Found {
    std::int32_t later;
    std::array<std::uint64_t, 2> masks;
  };
  std::vector<std::vector<Found>> found(nodes_.size());  // by the earlier leaf, in any order, with repetitions
  std::vector<std::int32_t> triangles;
  for (std::int32_t n = 0; n < std::ssize(nodes_); ++n) {
    for (std::int32_t i = 0; i < nodes_[std::size_t(n)].vertices; ++i) {
      triangles.clear();
      triangles_of(own_vertices_[std::size_t(nodes_[std::size_t(n)].first_vertex + i)], triangles);
      for (const std::int32_t t : triangles) {
        const auto [leaf, lane] = place_of[std::size_t(t)];
        Found one{std::max(n, leaf), {0, 0}};
        one.masks[n < leaf ? 0 : 1] = std::uint64_t(1) << (width * i + lane);
        if (leaf != n) found[std::size_t(std::min(n, leaf))].push_back(one);
      }
    }
  }
  // Returns a mask in which the bits of vertices and triangles that do not exist are set.
  const auto nothing = [](const Node& vertices, const Node& triangles) {
    std::uint64_t mask = ~std::uint64_t(0);
    for (int i = 0; i < vertices.vertices; ++i)
      for (int c = 0; c < triangles.count; ++c) mask &= ~(std::uint64_t(1) << (width * i + c));
    return mask;
  };
  SolidParts parts;
  parts.begin.push_back(0);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    std::ranges::sort(found[n], {}, &Found::later);
    for (const Found& one : found[n]) {
      if (std::ssize(parts.later) == parts.begin.back() || parts.later.back() != one.later) {
        const Node& later = nodes_[std::size_t(one.later)];
        parts.later.push_back(one.later);
        parts.masks.push_back({nothing(nodes_[n], later), nothing(later, nodes_[n])});
      }
      for (std::size_t k = 0; k < 2; ++k) parts.masks.back()[k] |= one.masks[k];
    }
    parts.begin.push_back(std::int32_t(parts.later.size()));
  }
  std::vector<std::int32_t> own(std::size_t(start_.x.rows()), 0);  // by vertex: its place in own_vertices_
  for (std::size_t i = 0; i < own_vertices_.size(); ++i) own[std::size_t(own_vertices_[i])] = std::int32_t(i);
  parts.corners.resize(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n)
    for (int c = 0; nodes_[n].is_leaf() && c < width; ++c)
      for (int k = 0; k < 3; ++k)
        parts.corners[n][std::size_t(3 * c + k)] =
            own[std::size_t(triangles_(~nodes_[n].child[std::size_t(c < nodes_[n].count ? c : 0)], k))];
  return parts;
}

// Walks down the tree through pairs of nodes, and leaves out those of which no triangles can meet.
struct MovingSurface::OwnSearch {
  using Lanes = Boxes::Lanes;
  using Family = SolidParts::Family;
  using Path = SolidParts::Path;
  // Names a child of a node.
  struct Child {
    std::int32_t node;
    int lane;
  };
  struct Pair {
    Child one, other;
  };
  using Mask = unsigned;  // a bit for each child of a node

  const MovingSurface& surface;
  SolidParts& parts;
  double margin;  // the query's margin, and what round-off may add to it [m]
  Vec3 carried;
  double same_way;
  const VisitPair& visit;
  std::vector<Pair> waiting = {};

  void find_paths(const Positions& q, const Positions& x) {
    parts.paths.resize(surface.own_vertices_.size());
    for (std::size_t i = 0; i < parts.paths.size(); ++i) {
      const double* const from = q.row(surface.own_vertices_[i]).data();
      const double* const to = x.row(surface.own_vertices_[i]).data();
      const Eigen::Array4d start(from[0], from[1], from[2], 0),
          end(to[0] - carried[0], to[1] - carried[1], to[2] - carried[2], 0);
      parts.paths[i] = {start, start.min(end), start.max(end)};
    }
  }

  // Children have larger indices than their node.
  void find_families() {
    parts.families.resize(surface.nodes_.size());
    for (std::size_t n = parts.families.size(); n-- > 0;) {
      const Node& node = surface.nodes_[n];
      Family& family = parts.families[n];
      if (node.is_leaf()) {
        set_leaf(parts.corners[n], family);
        continue;
      }
      for (int c = 0; c < width; ++c) {
        const Family& child = parts.families[std::size_t(node.child[std::size_t(c < node.count ? c : 0)])];
        put_box(whole_box(child.swept), family.swept, c);
        put_box(whole_box(child.normals), family.normals, c);
      }
    }
  }

  void set_leaf(const std::array<std::int32_t, 3 * width>& places, Family& family) const {
    Corners start;
    for (int c = 0; c < width; ++c) {
      const std::array<const Path*, 3> path = {&parts.paths[std::size_t(places[std::size_t(3 * c)])],
                                               &parts.paths[std::size_t(places[std::size_t(3 * c + 1)])],
                                               &parts.paths[std::size_t(places[std::size_t(3 * c + 2)])]};
      const Eigen::Array4d lower = path[0]->lower.min(path[1]->lower).min(path[2]->lower),
                           upper = path[0]->upper.max(path[1]->upper).max(path[2]->upper);
      put_box({lower.head<3>(), upper.head<3>()}, family.swept, c);
      for (std::size_t k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) start[k][std::size_t(axis)][c] = path[k]->start[axis];
    }
    family.normals.lower = family.normals.upper = unit_normals(start);
  }

  static void put_box(const Bounds& box, Boxes& boxes, int lane) {
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.lower[k][lane] = box.lower[int(k)];
      boxes.upper[k][lane] = box.upper[int(k)];
    }
  }

  std::int32_t index_of(const Child& child) const {
    return surface.nodes_[std::size_t(child.node)].child[std::size_t(child.lane)];
  }

  static Mask at_most(const Lanes& values, double most) {
    Mask mask = 0;
    for (int c = 0; c < width; ++c) mask |= Mask(values[c] <= most) << c;
    return mask;
  }

  // Tells which children of a node come near what moves in a box.
  Mask near(const Family& family, const double* lower, const double* upper) const {
    Lanes gap = Lanes::Constant(-infinity);
    for (std::size_t k = 0; k < 3; ++k)
      gap = gap.max(family.swept.lower[k] - upper[k]).max(lower[k] - family.swept.upper[k]);
    return at_most(gap, margin);
  }

  // Tells which children of a node may meet a child of another node, or of the same.
  Mask may_meet(std::int32_t node, const Child& one) const {
    const Family &family = parts.families[std::size_t(node)], &of_one = parts.families[std::size_t(one.node)];
    std::array<double, 3> lower{}, upper{};
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = of_one.swept.lower[k][one.lane];
      upper[k] = of_one.swept.upper[k][one.lane];
    }
    const Mask is_near = near(family, lower.data(), upper.data());
    if (is_near == 0) return is_near;
    Lanes cosine = Lanes::Zero();  // a lower bound of the cosines between normals of both
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes &low = family.normals.lower[k], &high = family.normals.upper[k];
      const double least = of_one.normals.lower[k][one.lane], most = of_one.normals.upper[k][one.lane];
      cosine += (low * least).min(low * most).min(high * least).min(high * most);
    }
    return is_near & at_most(cosine, same_way);
  }

  // Returns what is left out of two leaves. Few lie beside one.
  std::array<std::uint64_t, 2> masks_of(std::int32_t earlier, std::int32_t later) const {
    auto at = std::size_t(parts.begin[std::size_t(earlier)]);
    const auto end = std::size_t(parts.begin[std::size_t(earlier) + 1]);
    while (at < end && parts.later[at] < later) ++at;
    if (at == end || parts.later[at] != later) return {0, 0};
    return parts.masks[at];
  }

  // Visits a leaf's vertices with the triangles of another leaf that may come near, but for those in the mask, until a
  // call returns true; tells whether one did.
  bool any_of_leaves(std::int32_t leaf, std::int32_t other, std::uint64_t mask) const {
    const Node &one = surface.nodes_[std::size_t(leaf)], &node = surface.nodes_[std::size_t(other)];
    for (std::int32_t i = 0; i < one.vertices; ++i, mask >>= width) {
      const Path& path = parts.paths[std::size_t(one.first_vertex + i)];
      const Mask is_near = near(parts.families[std::size_t(other)], path.lower.data(), path.upper.data());
      if ((is_near & ~mask) == 0) continue;
      const std::int32_t v = surface.own_vertices_[std::size_t(one.first_vertex + i)];
      for (int c = 0; c < node.count; ++c)
        if ((is_near & ~mask) >> c & 1 && visit(v, ~node.child[std::size_t(c)])) return true;
    }
    return false;
  }
  bool any_of_leaves(std::int32_t a, std::int32_t b) const {
    const std::int32_t earlier = std::min(a, b), later = std::max(a, b);
    const auto [masks_of_earlier, masks_of_later] = masks_of(earlier, later);
    return (~masks_of_earlier != 0 && any_of_leaves(earlier, later, masks_of_earlier)) ||
           (~masks_of_later != 0 && any_of_leaves(later, earlier, masks_of_later));
  }

  // Visits two leaves, or pairs the children of the larger part, or those of both, for later.
  bool any_of(const Pair& pair) {
    const std::int32_t a = index_of(pair.one), b = index_of(pair.other);
    const Node &one = surface.nodes_[std::size_t(a)], &other = surface.nodes_[std::size_t(b)];
    if (one.is_leaf() && other.is_leaf()) return any_of_leaves(a, b);
    if (one.is_leaf()) {
      wait(pair.one, b, 0);
    } else if (other.is_leaf()) {
      wait(pair.other, a, 0);
    } else {
      for (int c = 0; c < one.count; ++c) wait({a, c}, b, 0);
    }
    return false;
  }

  // Pairs a part with those children of a node, from a number on, that it may meet.
  void wait(const Child& one, std::int32_t node, int first) {
    const Mask meets = may_meet(node, one);
    for (int d = first; d < surface.nodes_[std::size_t(node)].count; ++d)
      if ((meets >> d & 1) != 0) waiting.push_back({one, {node, d}});
  }

  bool any() {
    for (std::int32_t n = 0; n < std::ssize(surface.nodes_); ++n) {
      const Node& node = surface.nodes_[std::size_t(n)];
      for (int c = 0; !node.is_leaf() && c < node.count; ++c) wait({n, c}, n, c + 1);
      while (!waiting.empty()) {
        const Pair pair = waiting.back();
        waiting.pop_back();
        if (any_of(pair)) return true;
      }
    }
    return false;
  }
};

bool MovingSurface::any_own_pair(SolidParts& parts, const Positions& q, const Positions& x, double margin,
                                 const Vec3& carried, double same_way, const VisitPair& visit) const {
  SUPPLE_CHECK(q.rows(), ==, start_.x.rows());
  SUPPLE_CHECK(x.rows(), ==, start_.x.rows());
  OwnSearch search{*this, parts, margin, carried, same_way, visit};
  search.find_paths(q, x);
  search.find_families();
  const Bounds box = whole_box(parts.families[0].swept);
  search.margin = margin + roundoff_at(box.lower, box.upper) + 2 * roundoff_at(carried, carried);
  return search.any();
}

}  // namespace supple
