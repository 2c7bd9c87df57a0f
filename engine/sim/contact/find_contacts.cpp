#include "sim/contact/find_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "sim/contact/way_out.h"

namespace supple {
namespace {

constexpr int group_size = 64;     // consecutive vertices; the order of elimination keeps neighbours together
constexpr int groups_a_chunk = 8;  // a thread takes so many; fixed, so that results do not depend on threads
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double furthest_way_out = 100;  // that is looked for, over the body's size

int groups_of(const Model& model) { return (model.free + group_size - 1) / group_size; }

// A vertex that has moved by `way` since the step began, and would have moved by `freely` if nothing held it, gets a
// plane within this distance of a surface, because an iteration may still move it that much further. A vertex at rest
// hardly moves, but the next iteration may move it as far as gravity would.
double reach_of(double way, double freely) { return 0.25 * std::max(way, freely); }

// The way that a vertex may make out of an overlap in one step [m].
double push_out_of(const Model& model, const StepInputs& inputs) {
  return inputs.solver.contact.push_out * model.size * model.time_step;
}

// Holds everything that is needed to examine one vertex.
struct Search {
  const Model& model;
  const StepInputs& inputs;
  const Positions& x;
  ContactWork& work;

  ColliderView view(std::size_t c) const {
    return ColliderView((*inputs.colliders)[c], inputs.collider_motions[c], work.traits[c]);
  }

  // The memory of queries for a vertex. Its first query starts from what the vertex before it in its group has found.
  std::int32_t& memory(std::size_t c, int v) const {
    std::int32_t& own = work.memory[c * model.free + v];
    if (own < 0 && v % group_size > 0) own = work.memory[c * model.free + v - 1];
    return own;
  }

  // Returns the signed distance of vertex v at the start of the step, which is computed once.
  double start_field(const ColliderView& view, std::size_t c, int v, const Vec3& a) const {
    double& known = work.clearance[c * model.free + v];
    if (std::isnan(known)) known = view.distance(a, memory(c, v));
    return known;
  }

  // Returns the least signed distance of all vertices at the start of the step, as far as it is negative.
  double deepest_start(std::size_t c) const {
    const ColliderView own = view(c);
    double least = 0;
    for (int v = 0; v < model.free; ++v) {
      if (work.group_distance[c * groups_of(model) + v / group_size] >= 0) continue;
      least = std::min(least, start_field(own, c, v, own.at_start(work.start.row(v))));
    }
    return least;
  }

  // Calls found(v, way, field_at_start, reach) for the vertices of a group that may have met collider c.
  template <class Found>
  void near(std::size_t c, const ColliderView& view, int group, const Found& found) const {
    const int groups = groups_of(model);
    const std::size_t at = c * groups + group;
    const double moved = work.group_move[group] + work.collider_move[at];
    const double freely = work.group_free_move[group] + work.collider_move[at];
    if (moved + reach_of(moved, freely) < view.clear(work.group_distance[at])) return;
    const int end = std::min(model.free, (group + 1) * group_size);
    for (int v = group * group_size; v < end; ++v) {
      const Way way = view.way(work.start.row(v), x.row(v));
      const double reach = reach_of(way.length, view.length_to(work.prediction->row(v), way));
      const double field = start_field(view, c, v, way.a);
      if (way.length + reach < view.clear(field)) continue;
      found(v, way, field, reach);
    }
  }
};

// Finds the largest distance of each group's vertices from where they started.
void measure_moves(const Model& model, const Positions& x, const ContactWork& work, std::vector<double>& moves) {
  moves.resize(groups_of(model));
  for (int group = 0; group < groups_of(model); ++group) {
    double most = 0;
    const int end = std::min(model.free, (group + 1) * group_size);
    for (int v = group * group_size; v < end; ++v) most = std::max(most, (x.row(v) - work.start.row(v)).squaredNorm());
    moves[group] = std::sqrt(most);
  }
}

// Sets the plane of a vertex that started inside a collider which the body leaves by a common way: at the end of the
// step it lies as much further along that way as it may go, or as it has left to go. It slides out without friction.
void leave(const ColliderView& view, const Way& way, const Vec3& way_out, double field, double push_out,
           std::int32_t& near, Contact& contact) {
  const Eigen::Isometry3d motion = view.motion_after(0);
  const Vec3 local = view.end().linear().transpose() * motion.linear() * way_out;
  double left = 0;
  for (double at = field; at < 0 && left < push_out; at = view.distance(way.a + left * local, near))
    left += std::max(view.clear(-at), 0.02 * push_out);
  contact.normal = motion.linear() * way_out;
  contact.offset = contact.normal.dot(view.carried(way.q)) + std::min(left, push_out);
  contact.depth = std::max(0.0, contact.offset - contact.normal.dot(way.x));
}

// Returns the normal force from which friction follows (Li et al. 2020, section 5.3, lag it too). It is the force on
// the vertex when the step began or, where the vertex arrives or comes out of a deep overlap, at most the force that
// stops it alone. The overlap of an iterate would give a force that is many times too large; it only reduces friction,
// smoothly, on a vertex that is leaving. With a jump at the surface, vertices would touch and leave without end.
double lagged_force(const Contact& contact, double depth_before, double depth_unhindered, double mass_over_h2) {
  const double pressing = 2 * contact.stiffness * contact.depth;
  if (depth_before > 0) return 2 * std::min(contact.stiffness * depth_before, pressing);
  return std::min(mass_over_h2 * std::max(0.0, depth_unhindered), pressing);
}

// Returns the XXH64 of all pairs of vertex and collider that touch.
std::uint64_t set_of(const std::vector<Contact>& contacts) {
  std::uint64_t hash = 1;
  for (const Contact& contact : contacts) {
    if (contact.depth <= 0) continue;
    const std::int32_t pair[] = {contact.vertex, contact.collider};
    hash = hash_bytes(pair, sizeof pair, hash);
  }
  return hash;
}

bool before(const Contact& a, const Contact& b) {
  return a.collider != b.collider ? a.collider < b.collider : a.vertex < b.vertex;
}

// Counts the pairs that touch in one list and not in the other; both lists are sorted.
int changes_between(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  int changes = 0;
  std::size_t i = 0, j = 0;
  const auto skip = [](const std::vector<Contact>& list, std::size_t& at) {
    while (at < list.size() && list[at].depth <= 0) ++at;
  };
  for (;;) {
    skip(a, i);
    skip(b, j);
    if (i == a.size() && j == b.size()) return changes;
    if (j == b.size() || (i < a.size() && before(a[i], b[j]))) {
      ++changes;
      ++i;
    } else if (i == a.size() || before(b[j], a[i])) {
      ++changes;
      ++j;
    } else {
      ++i;
      ++j;
    }
  }
}

// Finds a common way out where the body starts so deep inside a collider that it cannot leave it in this step.
void find_way_out(const Model& model, const StepInputs& inputs, ContactWork& work) {
  const std::vector<Collider>& colliders = *inputs.colliders;
  const double push_out = push_out_of(model, inputs);
  const Search search{model, inputs, work.start, work};
  std::vector<std::size_t> deep;
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    if (search.deepest_start(c) < -push_out) deep.push_back(c);
  }
  work.way_out.assign(colliders.size(), Vec3::Zero());
  if (deep.empty()) return;
  std::vector<Eigen::Isometry3d> poses;
  for (const ColliderMotion& motion : inputs.collider_motions) poses.push_back(motion.start);
  const std::optional<WayOut> way =
      way_out(Obstacles(colliders, poses), work.start, 0.1 * push_out, furthest_way_out * model.size);
  for (const std::size_t c : deep) work.way_out[c] = way ? way->direction : Vec3::Zero();
}

}  // namespace

void forget_counts(ContactWork& work) {
  work.counts = {};
  work.set_before = work.set_now = 0;
}

void begin_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    ContactWork& work) {
  const std::size_t colliders = inputs.colliders->size();
  const int groups = groups_of(model);
  SUPPLE_CHECK(inputs.collider_motions.size(), ==, colliders);
  forget_counts(work);
  work.prediction = &y;
  work.stick_length = inputs.solver.contact.stick * model.size * model.time_step;
  work.start = q.topRows(model.free);
  work.clearance.assign(colliders * model.free, unknown);
  work.memory.assign(colliders * model.free, -1);
  work.group_distance.resize(colliders * groups);
  work.collider_move.resize(colliders * groups);
  measure_moves(model, y, work, work.group_free_move);
  work.by_chunk.resize((groups + groups_a_chunk - 1) / groups_a_chunk);
  work.traits.clear();
  for (const Collider& collider : *inputs.colliders)
    work.traits.push_back({collider.shape.certainty(), collider.shape.half_thickness()});
  for (int group = 0; group < groups; ++group) {
    const int first = group * group_size, count = std::min(model.free - first, group_size);
    const Vec3 center = work.start.middleRows(first, count).colwise().mean().transpose();
    const double radius = std::sqrt(
        (work.start.middleRows(first, count).rowwise() - center.transpose()).rowwise().squaredNorm().maxCoeff());
    for (std::size_t c = 0; c < colliders; ++c) {
      std::int32_t near = -1;
      const ColliderMotion& motion = inputs.collider_motions[c];
      const ColliderView view((*inputs.colliders)[c], motion, work.traits[c]);
      // A point at `radius` from the centre moves with the centre and rotates about it.
      const double turn = Eigen::AngleAxisd(motion.end.linear() * motion.start.linear().transpose()).angle();
      double& moves = work.collider_move[c * groups + group];
      moves = (view.carried(center) - center).norm() + turn * radius;
      work.group_distance[c * groups + group] =
          view.distance(view.at_start(center), near) - radius / work.traits[c].certainty;
    }
  }
  find_way_out(model, inputs, work);
}

void find_contacts(const Model& model, const StepInputs& inputs, const Positions& x, Threads* threads,
                   ContactWork& work, std::vector<Contact>& found) {
  const ContactSettings& settings = inputs.solver.contact;
  const double h = model.time_step, unit_stiffness = settings.stiffness / (h * h);
  const double push_out = push_out_of(model, inputs);
  found.clear();
  measure_moves(model, x, work, work.group_move);
  const int groups = groups_of(model);
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Search search{model, inputs, x, work};
    const ColliderView view = search.view(c);
    const double friction = (*inputs.colliders)[c].friction;
    const auto examine = [&](std::vector<Contact>& list, int v, const Way& way, double field, double reach) {
      Contact contact{v, static_cast<std::int32_t>(c), Vec3::Zero(), 0, unit_stiffness * model.mass[v], 0};
      const Vec3& way_out = work.way_out[c];
      std::int32_t& near = search.memory(c, v);
      const bool leaving = !way_out.isZero(0);
      if (leaving && field <= 0) {
        leave(view, way, way_out, field, push_out, near, contact);
        return list.push_back(contact);
      }
      const std::optional<SurfacePoint> surface = view.holding(way, field, reach, near);
      if (!surface) return;
      contact.normal = view.end().linear() * surface->normal;
      if (leaving && contact.normal.dot(way_out) < 0.5) return;  // the others, which leave, pull it through
      // This much of the depth need not be corrected in this step.
      const double allowed = field < -push_out ? std::max(0.0, -view.closest(way.a, near).distance - push_out) : 0;
      contact.offset = contact.normal.dot(view.end() * surface->point) - allowed;
      contact.depth = std::max(0.0, contact.offset - contact.normal.dot(x.row(v)));
      if (friction > 0) {
        contact.origin = view.carried(work.start.row(v));
        contact.friction = friction * lagged_force(contact, allowed > 0 ? 0 : -field,
                                                   contact.offset - contact.normal.dot(work.prediction->row(v)),
                                                   model.scheme.inertia * model.mass[v] / (h * h));
      }
      list.push_back(contact);
    };
    const int chunks = static_cast<int>(work.by_chunk.size());
    const long questions =
        long(model.free) *
        (work.traits[c].half_thickness > 0 ? 1 : 50);  // thin shapes need rays, meshes need triangles
    run_chunks(threads, chunks, questions, [&](int chunk) {
      std::vector<Contact>& list = work.by_chunk[chunk];
      list.clear();
      for (int group = chunk * groups_a_chunk; group < std::min(groups, (chunk + 1) * groups_a_chunk); ++group) {
        search.near(c, view, group,
                    [&](int v, const Way& way, double field, double reach) { examine(list, v, way, field, reach); });
      }
    });
    for (const auto& list : work.by_chunk) found.insert(found.end(), list.begin(), list.end());
  }
}

void count_contacts(const std::vector<Contact>& before, const std::vector<Contact>& now, ContactWork& work) {
  work.counts.touching =
      static_cast<int>(std::count_if(now.begin(), now.end(), [](const Contact& k) { return k.depth > 0; }));
  const std::uint64_t set = set_of(now);
  if (work.set_now != 0) {
    work.counts.changes += changes_between(before, now);
    work.counts.cycles += set == work.set_before && set != work.set_now;
  }
  work.set_before = work.set_now;
  work.set_now = set;
}

namespace {

// Returns which share of a way a vertex may go before it is deeper than `allowed` [m]. A vertex that touches already is
// stopped only by a collider that comes to it: one that rests would be stopped on every step by its own weight.
double share_to_impact(const ColliderView& view, const Way& way, double field, double allowed, std::int32_t& near) {
  if (field <= 0) {
    if (!view.moves()) return 1;
    const Vec3 normal = view.closest(way.a, near).normal;
    const double comes = -normal.dot(view.pace(view.way(way.q, way.q), 0)), falls = -normal.dot(view.pace(way, 0));
    return std::min(comes, falls) > allowed ? allowed / falls : 1;
  }
  const std::optional<ColliderView::Entry> entered = view.entry(way, field, near);
  if (!entered) return 1;
  // Towards the surface, over a whole step.
  const double falls = -entered->surface.normal.dot(view.pace(way, entered->way));
  return falls * (1 - entered->way) > allowed ? entered->way + allowed / falls : 1;
}

}  // namespace

Impact first_impact(const Model& model, const StepInputs& inputs, const Positions& x, double allowed,
                    ContactWork& work) {
  measure_moves(model, x, work, work.group_move);
  Impact first;
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Search search{model, inputs, x, work};
    const ColliderView view = search.view(c);
    for (int group = 0; group < groups_of(model); ++group) {
      search.near(c, view, group, [&](int v, const Way& way, double field, double) {
        const double share = share_to_impact(view, way, field, allowed, search.memory(c, v));
        if (share < first.share) first = {share, static_cast<int>(c)};
      });
    }
  }
  return first;
}

Eigen::Isometry3d motion_after(const StepInputs& inputs, int collider, double share) {
  return ColliderView((*inputs.colliders)[collider], inputs.collider_motions[collider], {}).motion_after(share);
}

int most_touched(const std::vector<Contact>& contacts, std::size_t colliders) {
  std::vector<int> touching(colliders, 0);
  for (const Contact& contact : contacts) touching[contact.collider] += contact.depth > 0;
  const auto most = std::max_element(touching.begin(), touching.end());
  return most == touching.end() || *most == 0 ? -1 : static_cast<int>(most - touching.begin());
}

}  // namespace supple
