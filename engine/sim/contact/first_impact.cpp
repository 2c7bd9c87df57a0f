// Finds where bodies meet colliders and each other first, and what they touch most.
#include "sim/contact/usual_depth.h"
#include "sim/contact/vertex_search.h"

namespace supple {
namespace {

// Returns which share of a way a point may go before it is deeper than `allowed` [m]; 1 also where the share is no less
// than `least`. A point that touches already is stopped only by a collider that comes to it: by its own weight, a point
// that rests would be stopped in every step.
double share_to_impact(const ColliderView& view, const Way& way, double field, double allowed, double least,
                       QueryMemory& near) {
  if (field <= 0) {
    if (!view.moves()) return 1;
    const Vec3 normal = view.closest(way.a, near).normal;
    const double comes = -normal.dot(view.pace(view.way(way.q, way.q), 0)), falls = -normal.dot(view.pace(way, 0));
    return std::min(comes, falls) > allowed ? allowed / falls : 1;
  }
  // The depth grows no faster than the way.
  const double furthest = least * way.length - (1 - 1e-9) * allowed;
  if (view.clear(field) > furthest) return 1;
  const std::optional<ColliderView::Entry> entered = view.entry(way, field, near, furthest / way.length);
  if (!entered) return 1;
  // The way of the point towards the surface over a whole step [m].
  const double falls = -entered->surface.normal.dot(view.pace(way, entered->way));
  return falls * (1 - entered->way) > allowed ? entered->way + allowed / falls : 1;
}

}  // namespace

std::vector<Impact> first_impacts(const Model& model, const StepInputs& inputs, const Positions& x, ContactWork& work) {
  measure_moves(model, x, work, work.group_move);
  std::vector<Impact> first(model.parts.size());
  const auto impact_of = [&](std::int32_t v) -> Impact& { return first[model.part_number(v)]; };
  for (std::size_t c = 0; c < collider_count(inputs); ++c) {
    const VertexSearch search{model, inputs, x, work};
    const ColliderView view = search.view(c);
    const auto allowed = [&](std::int32_t v) {
      return usual_depth(model.part_of(v).size, (*inputs.colliders)[c], work.traits[c].usual_half_thickness);
    };
    for (int group = 0; group < vertex_groups(model); ++group) {
      search.near(c, view, group, [&](int v, const Way& way, double field, double) {
        Impact& impact = impact_of(v);
        const double share = share_to_impact(view, way, field, allowed(v), impact.share, search.memory(c, v));
        if (share < impact.share) impact = {share, static_cast<int>(c)};
      });
    }
    for (FacePoint& face : work.faces[c].points) {
      const Way way = view.way(face.stencil.at(*work.begin), face.stencil.at(x));
      if (way.length < view.clear(face.field)) continue;
      const std::int32_t v = face.stencil.vertex[0];
      const double share = share_to_impact(view, way, face.field, allowed(v), impact_of(v).share, face.near);
      if (share < impact_of(v).share) impact_of(v) = {share, static_cast<int>(c)};
    }
  }
  std::vector<double> shares;
  for (const Impact& impact : first) shares.push_back(impact.share);
  stop_at_surfaces(model, inputs, *work.begin, x, work.surfaces, shares);
  for (std::size_t p = 0; p < first.size(); ++p) {
    if (shares[p] < first[p].share) first[p] = {shares[p], -1};
  }
  return first;
}

Eigen::Isometry3d motion_after(const StepInputs& inputs, int collider, double share, const Part& part,
                               const Positions& q) {
  const ColliderView view((*inputs.colliders)[collider], inputs.collider_motions[collider], {});
  if (!view.deforms()) return view.motion_after(share);
  return view.motion_near(q.middleRows(part.first_free, part.free).colwise().mean().transpose(), share);
}

Vec3 carried_by(const StepInputs& inputs, int collider, const Vec3& place) {
  const ColliderView view((*inputs.colliders)[collider], inputs.collider_motions[collider], {});
  return view.deforms() ? view.carried(place) : view.motion_after(0) * place;
}

int most_touched(const Model& model, const Part& part, const std::vector<Contact>& contacts, std::size_t colliders) {
  std::vector<int> touching(colliders, 0);
  for (const Contact& contact : contacts) {
    if (contact.other.is_collider() && &model.part_of(contact.stencil.vertex[0]) == &part)
      touching[contact.other.collider] += contact.depth > 0;
  }
  const auto most = std::max_element(touching.begin(), touching.end());
  return most == touching.end() || *most == 0 ? -1 : static_cast<int>(most - touching.begin());
}

}  // namespace supple
