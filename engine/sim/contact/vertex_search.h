// Looks through a body's vertices for those that may have met a collider: groups of vertices first, then one by one.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/contact/find_contacts.h"
#include "sim/contact/reach.h"

namespace supple {

constexpr int vertices_a_group = 64;  // consecutive ones; the order of elimination keeps neighbours together

inline int vertex_groups(const Model& model) { return (model.free + vertices_a_group - 1) / vertices_a_group; }

// Holds everything that is needed to examine one vertex.
struct VertexSearch {
  const Model& model;
  const StepInputs& inputs;
  const Positions& x;
  ContactWork& work;

  ColliderView view(std::size_t c) const {
    return ColliderView((*inputs.colliders)[c], inputs.collider_motions[c], work.traits[c]);
  }

  // Returns where a vertex starts as seen from a collider; for one that deforms, it is found once.
  Vec3 place_at_start(const ColliderView& view, std::size_t c, int v) const {
    if (!view.deforms()) return view.at_start(work.start.row(v));
    Vec3& known = work.carried[c * model.free + v];
    if (std::isnan(known.x())) known = view.at_start(work.start.row(v));
    return known;
  }

  // Returns the memory of queries for a vertex. Its first query starts from what the vertex before it in its group has
  // found.
  QueryMemory& memory(std::size_t c, int v) const {
    std::vector<QueryMemory>& of_collider = work.memories[c].by_vertex;
    if (of_collider.empty()) return work.no_memory;
    if (of_collider[v].leaf < 0 && v % vertices_a_group > 0) of_collider[v].leaf = of_collider[v - 1].leaf;
    return of_collider[v];
  }

  // Tells whether a place is certainly further out than `most`, without asking how far. is_outside: whether the place
  // is known to be outside.
  static bool is_certainly_clear(const ColliderView& view, const Vec3& p, double most, bool is_outside,
                                 QueryMemory& near) {
    return most < view.certain_distance(p, near) ||
           (is_outside && view.knows_bounds() && !view.closest_within(p, most, near));
  }

  // Tells whether a vertex whose distance at the start is known is so far away that its way need not be followed
  // through the collider's frame. collider_move: how far the collider's own points near it move.
  bool is_clear_from_afar(const ColliderView& view, std::size_t c, int v, double collider_move) const {
    const double field = work.clearance[c * model.free + v];
    if (std::isnan(field)) return false;
    const Vec3 start = work.start.row(v);
    const double moved = (work.place(x, v) - start).norm() + collider_move;
    const double freely = (work.place(*work.prediction, v) - start).norm() + collider_move;
    return moved + reach_of(moved, freely) < view.clear(field);
  }

  // Returns the signed distance of vertex v at the start of the step, which is computed once.
  double start_field(const ColliderView& view, std::size_t c, int v, const Vec3& a) const {
    double& known = work.clearance[c * model.free + v];
    if (std::isnan(known)) known = view.distance(a, memory(c, v));
    return known;
  }

  // Returns the least signed distance of a part's vertices at the start of the step, or `above` where none is below
  // that.
  double deepest_start(std::size_t c, const Part& part, double above) const {
    const ColliderView own = view(c);
    double least = above;
    for (int v = part.first_free; v < part.first_free + part.free; ++v) {
      if (work.group_distance[c * vertex_groups(model) + v / vertices_a_group] >= above) continue;
      const Vec3 place = place_at_start(own, c, v);
      if (own.certain_distance(place, memory(c, v)) >= above) continue;
      least = std::min(least, start_field(own, c, v, place));
    }
    return least;
  }

  // Calls found(v, way, field_at_start, reach) for the vertices of a group that may have met collider c.
  template <class Found>
  void near(std::size_t c, const ColliderView& view, int group, const Found& found) const {
    const int groups = vertex_groups(model);
    const std::size_t at = c * groups + group;
    const double moved = work.group_move[group] + work.collider_move[at];
    const double freely = work.group_free_move[group] + work.collider_move[at];
    if (moved + reach_of(moved, freely) < view.clear(work.group_distance[at])) return;
    const int end = std::min(model.free, (group + 1) * vertices_a_group);
    for (int v = group * vertices_a_group; v < end; ++v) {
      if (is_clear_from_afar(view, c, v, work.collider_move[at])) continue;
      const Way way = view.way_from(place_at_start(view, c, v), work.start.row(v), work.place(x, v));
      const double reach = reach_of(way.length, view.length_to(work.place(*work.prediction, v), way));
      const bool asked = !std::isnan(work.clearance[c * model.free + v]);
      if (!asked && is_certainly_clear(view, way.a, way.length + reach, work.group_distance[at] > 0, memory(c, v)))
        continue;
      const double field = start_field(view, c, v, way.a);
      if (way.length + reach < view.clear(field)) continue;
      found(v, way, field, reach);
    }
  }
};

// Finds the largest distance of each group's vertices from where they started.
void measure_moves(const Model& model, const Positions& x, const ContactWork& work, std::vector<double>& moves);

}  // namespace supple
