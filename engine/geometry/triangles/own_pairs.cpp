// Defines how a MovingSurface finds the places at which it may meet itself.
#include "geometry/triangles/moving_boxes.h"
#include "geometry/triangles/moving_surface.h"

namespace supple {

// Walks down the tree through pairs of nodes, and leaves out those of which no triangles can meet.
struct MovingSurface::OwnSearch {
  const MovingSurface& surface;
  double margin;  // the query's margin, and what round-off may add to it [m]
  Vec3 carried;
  double same_way;
  std::vector<Boxes> normals;  // by node: boxes around the unit normals of what its children hold

  using Lanes = Boxes::Lanes;

  void find_normals() {
    Boxes empty;
    empty.lower.fill(Lanes::Constant(infinity));
    empty.upper.fill(Lanes::Constant(-infinity));
    normals.assign(surface.nodes_.size(), empty);
    for (std::size_t n = normals.size(); n-- > 0;) {
      const Node& node = surface.nodes_[n];
      for (int c = 0; c < node.count; ++c) {
        const std::int32_t child = node.child[std::size_t(c)];
        Bounds box;
        if (child < 0) {
          box.lower = box.upper = surface.unit_normal(surface.start_, ~child);
        } else {
          box = whole_box(normals[std::size_t(child)]);
        }
        for (int axis = 0; axis < 3; ++axis) {
          normals[n].lower[std::size_t(axis)][c] = box.lower[axis];
          normals[n].upper[std::size_t(axis)][c] = box.upper[axis];
        }
      }
    }
  }

  // Tells which of a node's children may meet what moves in `box` and has its normals in `facing`.
  std::array<bool, width> may_meet(std::int32_t node, const Bounds& box, const Bounds& facing) const {
    const auto n = std::size_t(node);
    const Lanes gap = gaps(surface.start_.boxes[n], surface.end_.boxes[n], carried, box);
    Lanes cosine = Lanes::Zero();  // a lower bound of the cosines between normals of both
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = std::size_t(axis);
      const Lanes &low = normals[n].lower[k], &high = normals[n].upper[k];
      cosine += (low * facing.lower[axis])
                    .min(low * facing.upper[axis])
                    .min(high * facing.lower[axis])
                    .min(high * facing.upper[axis]);
    }
    std::array<bool, width> meets{};
    for (int c = 0; c < surface.nodes_[n].count; ++c) meets[std::size_t(c)] = gap[c] <= margin && cosine[c] <= same_way;
    return meets;
  }

  Bounds swept_lane(std::int32_t node, int c) const {
    const Boxes &start = surface.start_.boxes[std::size_t(node)], &end = surface.end_.boxes[std::size_t(node)];
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = std::size_t(axis);
      box.lower[axis] = std::min(start.lower[k][c], end.lower[k][c] - carried[axis]);
      box.upper[axis] = std::max(start.upper[k][c], end.upper[k][c] - carried[axis]);
    }
    return box;
  }

  Bounds normal_lane(std::int32_t node, int c) const {
    const Boxes& all = normals[std::size_t(node)];
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = all.lower[std::size_t(axis)][c];
      box.upper[axis] = all.upper[std::size_t(axis)][c];
    }
    return box;
  }

  // Visits a leaf's vertices with the triangles of another leaf that may come near, until a call returns true; tells
  // whether one did.
  bool any_of_leaves(const Node& leaf, std::int32_t other, const VisitPair& visit) const {
    const auto n = std::size_t(other);
    for (std::int32_t i = 0; i < leaf.vertices; ++i) {
      const std::int32_t v = surface.own_vertices_[std::size_t(leaf.first_vertex + i)];
      const Bounds path = box_of_path(surface.start_.x.row(v), surface.end_.x.row(v), carried, 0);
      const Lanes gap = gaps(surface.start_.boxes[n], surface.end_.boxes[n], carried, path);
      const Node& node = surface.nodes_[n];
      for (int c = 0; c < node.count; ++c)
        if (gap[c] <= margin && visit(v, ~node.child[std::size_t(c)])) return true;
    }
    return false;
  }

  bool any(const VisitPair& visit) const {
    std::vector<std::array<std::int32_t, 2>> waiting = {{0, 0}};
    while (!waiting.empty()) {
      const auto [a, b] = waiting.back();
      waiting.pop_back();
      const Node &one = surface.nodes_[std::size_t(a)], &other = surface.nodes_[std::size_t(b)];
      if (a == b) {
        if (one.is_leaf()) continue;
        for (int c = 0; c < one.count; ++c) {
          const std::int32_t child = one.child[std::size_t(c)];
          waiting.push_back({child, child});
          const auto meets = may_meet(a, swept_lane(a, c), normal_lane(a, c));
          for (int d = c + 1; d < one.count; ++d)
            if (meets[std::size_t(d)]) waiting.push_back({child, one.child[std::size_t(d)]});
        }
      } else if (one.is_leaf() && other.is_leaf()) {
        if (any_of_leaves(one, b, visit) || any_of_leaves(other, a, visit)) return true;
      } else if (one.is_leaf() || other.is_leaf()) {
        const std::int32_t leaf = one.is_leaf() ? a : b, inner = one.is_leaf() ? b : a;
        const auto meets = may_meet(inner, surface.swept_box(leaf, carried), whole_box(normals[std::size_t(leaf)]));
        for (int c = 0; c < width; ++c)
          if (meets[std::size_t(c)])
            waiting.push_back({leaf, surface.nodes_[std::size_t(inner)].child[std::size_t(c)]});
      } else {
        for (int c = 0; c < one.count; ++c) {
          const auto meets = may_meet(b, swept_lane(a, c), normal_lane(a, c));
          for (int d = 0; d < other.count; ++d)
            if (meets[std::size_t(d)]) waiting.push_back({one.child[std::size_t(c)], other.child[std::size_t(d)]});
        }
      }
    }
    return false;
  }
};

bool MovingSurface::any_own_pair(double margin, const Vec3& carried, double same_way, const VisitPair& visit) const {
  const Bounds box = swept_box(0, carried);
  const double reach = margin + roundoff_at(box.lower, box.upper) + 2 * roundoff_at(carried, carried);
  OwnSearch search{*this, reach, carried, same_way, {}};
  search.find_normals();
  return search.any(visit);
}

}  // namespace supple
