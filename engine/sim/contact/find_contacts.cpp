#include "sim/contact/find_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/hash.h"

namespace supple {
namespace {

constexpr int group_size = 64;     // consecutive vertices; the order of elimination keeps neighbours together
constexpr int groups_a_chunk = 8;  // a thread takes so many; fixed, so that results do not depend on threads
constexpr int most_marches = 200;  // of a ray; one that needs more only grazes the surface
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

int groups_of(const Model& model) { return (model.free + group_size - 1) / group_size; }

// One collider over one step, in its own frame: a vertex goes from a = start^-1 q to b = end^-1 x, so that a moving
// collider stands still.
class View {
 public:
  View(const Collider& collider, const ColliderMotion& motion, const ColliderTraits& traits)
      : collider_(collider),
        end_(motion.end),
        to_start_(motion.start.inverse()),
        to_end_(motion.end.inverse()),
        traits_(traits) {}

  Vec3 at_start(const Vec3& world) const { return to_start_ * world; }
  Vec3 at_end(const Vec3& world) const { return to_end_ * world; }
  Vec3 carried(const Vec3& world) const { return end_ * (to_start_ * world); }  // moved with the collider
  const Eigen::Isometry3d& end() const { return end_; }

  // The distance to the layer around the shape.
  double distance(const Vec3& p) const { return collider_.shape.distance(p) - collider_.thickness; }
  SurfacePoint closest(const Vec3& p) const {
    SurfacePoint s = collider_.shape.closest(p);
    s.point += collider_.thickness * s.normal;
    s.distance -= collider_.thickness;
    return s;
  }

  // How far a point at this distance from the layer can certainly go without meeting it.
  double clear(double distance) const {
    return std::max(0.0, traits_.certainty * (distance + collider_.thickness) - collider_.thickness);
  }

  // Tells whether a way is too short to lead through the shape.
  bool short_way(double way) const { return way < traits_.half_thickness; }

  // Returns how far along the way from a (outside) to b the layer is met; nothing when it is not. Steps as long as the
  // distance never overshoot (Hart 1996, "Sphere tracing").
  std::optional<double> meets(const Vec3& a, const Vec3& b, double field_at_a) const {
    const double length = (b - a).norm();
    const double close = 1e-9 * (length + std::abs(field_at_a));
    double gone = 0, field = field_at_a;
    for (int march = 0; march < most_marches && field > close; ++march) {
      gone += clear(field);
      if (gone >= length) return std::nullopt;
      field = distance(a + gone / length * (b - a));
    }
    return length > 0 ? gone / length : 0.0;
  }

 private:
  const Collider& collider_;
  Eigen::Isometry3d end_, to_start_, to_end_;
  ColliderTraits traits_;
};

// The place where a vertex entered, or where it was if the step started inside.
struct Entry {
  SurfacePoint surface;
  double way;  // from a to b, 0 to 1
};

// Finds where the way from a to b enters; nothing when it stays outside.
std::optional<Entry> entry(const View& view, const Vec3& a, const Vec3& b, double field_at_a) {
  if (field_at_a <= 0) return Entry{view.closest(a), 0};
  const std::optional<double> way = view.meets(a, b, field_at_a);
  if (!way) return std::nullopt;
  return Entry{view.closest(a + *way * (b - a)), *way};
}

// Tells whether two normals belong to the two sides of a wall, not of an edge.
bool opposite(const Vec3& a, const Vec3& b) { return a.dot(b) < -0.5; }

// Finds the surface that holds a vertex which went from a to b: the closest one, unless it went through to another
// side; then it is the one by which the vertex entered. Nothing when there is none within `reach`.
std::optional<SurfacePoint> holding(const View& view, const Vec3& a, const Vec3& b, double field_at_a, double reach) {
  const SurfacePoint here = view.closest(b);
  if (view.short_way((b - a).norm() + std::max(0.0, -field_at_a)))
    return here.distance < reach ? std::optional(here) : std::nullopt;
  // The way leads straight onto the side that is closest: the usual case, which needs no ray.
  if (here.distance < 0 && field_at_a > 0 && (a - here.point).dot(here.normal) >= 0) return here;
  const std::optional<Entry> entered = entry(view, a, b, field_at_a);
  if (!entered) return here.distance < reach ? std::optional(here) : std::nullopt;
  if (here.distance < 0) return opposite(here.normal, entered->surface.normal) ? entered->surface : here;
  // The vertex is outside again. A way that cuts a corner may pass; one that leaves on the far side may not.
  const std::optional<double> back = view.meets(b, a, here.distance);
  const SurfacePoint left = back ? view.closest(b + *back * (a - b)) : here;
  if (opposite(left.normal, entered->surface.normal)) return entered->surface;
  return here.distance < reach ? std::optional(here) : std::nullopt;
}

// A vertex that moved `way` since the step began, and would have moved `freely` if nothing held it, gets a plane within
// this distance of a surface: an iteration may still move it that much further. What rests hardly moves, but the next
// iteration may move it as far as gravity would.
double reach_of(double way, double freely) { return 0.25 * std::max(way, freely); }

// Everything that the examination of one vertex needs.
struct Search {
  const Model& model;
  const StepInputs& inputs;
  const Positions& x;
  ContactWork& work;

  View view(std::size_t c) const { return View((*inputs.colliders)[c], inputs.collider_motions[c], work.traits[c]); }

  // Returns the signed distance of vertex v at the start of the step, which is computed once.
  double start_field(const View& view, std::size_t c, int v, const Vec3& a) const {
    double& known = work.clearance[c * model.free + v];
    if (std::isnan(known)) known = view.distance(a);
    return known;
  }

  // Calls found(v, a, b, field_at_a, reach) for the vertices of a group that may have met collider c.
  template <class Found>
  void near(std::size_t c, const View& view, int group, const Found& found) const {
    const int groups = groups_of(model);
    const std::size_t at = c * groups + group;
    const double moved = work.group_move[group] + work.collider_move[at];
    const double freely = work.group_free_move[group] + work.collider_move[at];
    if (moved + reach_of(moved, freely) < view.clear(work.group_distance[at])) return;
    const int end = std::min(model.free, (group + 1) * group_size);
    for (int v = group * group_size; v < end; ++v) {
      const Vec3 a = view.at_start(work.start.row(v)), b = view.at_end(x.row(v));
      const double way = (b - a).norm();
      const double reach = reach_of(way, (view.at_end(work.prediction->row(v)) - a).norm());
      const double field = start_field(view, c, v, a);
      if (way + reach < view.clear(field)) continue;
      found(v, a, b, field, reach);
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

// Returns the normal force from which friction follows (Li et al. 2020, section 5.3, lag it too): the force of the
// vertex when the step began, or, where it arrives or comes out of a deep overlap, no more than what stops it alone.
// The overlap of an iterate would give a force that is many times too large. It only reduces friction, smoothly, on a
// vertex that is leaving: with a jump at the surface, vertices would come and go without end.
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
      const ColliderMotion& motion = inputs.collider_motions[c];
      const View view((*inputs.colliders)[c], motion, work.traits[c]);
      work.group_distance[c * groups + group] =
          view.distance(view.at_start(center)) - radius / work.traits[c].certainty;
      // A point at `radius` from the centre moves as the centre does, and turns about it.
      const double turn = Eigen::AngleAxisd(motion.end.linear() * motion.start.linear().transpose()).angle();
      work.collider_move[c * groups + group] = (view.carried(center) - center).norm() + turn * radius;
    }
  }
}

void find_contacts(const Model& model, const StepInputs& inputs, const Positions& x, Threads* threads,
                   ContactWork& work, std::vector<Contact>& found) {
  const ContactSettings& settings = inputs.solver.contact;
  const double h = model.time_step, unit_stiffness = settings.stiffness / (h * h);
  const double push_out = settings.push_out * model.size * h;
  found.clear();
  measure_moves(model, x, work, work.group_move);
  const int groups = groups_of(model);
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Search search{model, inputs, x, work};
    const View view = search.view(c);
    const double friction = (*inputs.colliders)[c].friction;
    const auto examine = [&](std::vector<Contact>& list, int v, const Vec3& a, const Vec3& b, double field,
                             double reach) {
      const std::optional<SurfacePoint> surface = holding(view, a, b, field, reach);
      if (!surface) return;
      Contact contact{v, static_cast<std::int32_t>(c),   view.end().linear() * surface->normal,
                      0, unit_stiffness * model.mass[v], 0};
      // This much depth need not be undone in this step.
      const double allowed = field < -push_out ? std::max(0.0, -view.closest(a).distance - push_out) : 0;
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
        search.near(c, view, group, [&](int v, const Vec3& a, const Vec3& b, double field, double reach) {
          examine(list, v, a, b, field, reach);
        });
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

double way_to_impact(const Model& model, const StepInputs& inputs, const Positions& x, double allowed,
                     ContactWork& work) {
  measure_moves(model, x, work, work.group_move);
  double least = 1;
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Search search{model, inputs, x, work};
    const View view = search.view(c);
    for (int group = 0; group < groups_of(model); ++group) {
      search.near(c, view, group, [&](int, const Vec3& a, const Vec3& b, double field, double) {
        if (field <= 0) return;
        const std::optional<Entry> entered = entry(view, a, b, field);
        if (!entered) return;
        const double fall = entered->surface.normal.dot(a - b);  // towards the surface, over the whole way
        if (fall * (1 - entered->way) > allowed) least = std::min(least, entered->way + allowed / fall);
      });
    }
  }
  return least;
}

}  // namespace supple
