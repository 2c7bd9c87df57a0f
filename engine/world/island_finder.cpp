#include "world/island_finder.h"

#include <algorithm>
#include <array>

#include "base/disjoint_sets.h"
#include "base/trace.h"
#include "scene/definition/meeting.h"
#include "scene/definition/scene_def.h"
#include "sim/contact/sheet_layer.h"
#include "sim/solver/begin_step.h"

namespace supple {
namespace {

// Returns the members of each set, in the order of their first members.
std::vector<std::vector<std::size_t>> lists_of(DisjointSets& sets) {
  std::vector<std::vector<std::size_t>> by_first(sets.size()), lists;
  for (std::size_t i = 0; i < sets.size(); ++i) by_first[sets.of(i)].push_back(i);
  for (auto& list : by_first) {
    if (!list.empty()) lists.push_back(std::move(list));
  }
  return lists;
}

// Returns where a body's vertices would go if nothing touched them, with hard handles at their targets (n x 3) [m].
Positions free_motion(const Model& model, const StepInputs& inputs, const State& state, AirForces& air) {
  Positions y;
  inertial_prediction(model, inputs, state, y);
  begin_air(model, inputs, state, air);
  if (air.have_drag()) air.add_free_way(model, y);
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    if (model.handled[i].vertex >= model.free) y.row(model.handled[i].vertex) = inputs.targets.row(i);
  }
  return y;
}

}  // namespace

struct IslandFinder::Way {
  Positions y;               // n x 3 [m]
  Bounds swept;              // box of the body on its way from q to y
  Vec3 mean = Vec3::Zero();  // the body's mean motion [m]
  AirForces air;
  std::uint64_t structure = 0;
  double layer = 0;  // of a sheet, or the overhang of what is drawn: how far away contact keeps others [m]
  mutable std::unique_ptr<MovingSurface> surface;
  mutable bool is_moved = false;  // whether the surface goes the way of this step
};

IslandFinder::IslandFinder(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies)
    : scene_(scene), bodies_(bodies), ways_(bodies.size()) {}
IslandFinder::~IslandFinder() = default;

void IslandFinder::find_ways() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const MovingBody& body = *bodies_[b];
    Way& way = ways_[b];
    const Positions& q = body.state().x;
    way.y = free_motion(body.model(), body.inputs(), body.state(), way.air);
    way.mean = (way.y - q).colwise().mean().transpose();
    way.swept = bounds_of(q);
    const Bounds end = bounds_of(way.y);
    way.swept.include(end.lower);
    way.swept.include(end.upper);
    way.is_moved = false;
    if (way.structure == body.model().structure) continue;
    way.surface.reset();
    way.structure = body.model().structure;
    const Model& model = body.model();
    way.layer = model.parts.front().solid ? 0 : sheet_layer(mean_edge(model.surface, model.rest));
    for (const double overhang : model.overhang) way.layer = std::max(way.layer, overhang);
  }
}

MovingSurface& IslandFinder::surface_of(std::size_t body) const {
  const Way& way = ways_[body];
  const Model& model = bodies_[body]->model();
  if (way.surface == nullptr) way.surface = std::make_unique<MovingSurface>(model.surface, model.rest);
  if (!way.is_moved) {
    way.surface->set_start(bodies_[body]->state().x);
    way.surface->set_end(way.y);
  }
  way.is_moved = true;
  return *way.surface;
}

// Tells whether two bodies may touch in the step. pushed: how far others may push them off their ways [m].
bool IslandFinder::may_touch(std::size_t a, std::size_t b, double pushed) const {
  constexpr double near = 0.01;  // of the smaller body's size
  const Model &one = bodies_[a]->model(), &other = bodies_[b]->model();
  if (one.surface.rows() == 0 || other.surface.rows() == 0) return false;
  const double h = one.time_step;
  const double margin = near * std::min(one.size, other.size) + 0.25 * h * h * scene_.gravity.norm() + pushed +
                        ways_[a].layer + ways_[b].layer;
  for (int k = 0; k < 3; ++k) {
    if (ways_[a].swept.lower[k] - margin > ways_[b].swept.upper[k] ||
        ways_[b].swept.lower[k] - margin > ways_[a].swept.upper[k])
      return false;
  }
  // Bodies that go the same way meet where a collider stops the first of them, so their whole ways count then.
  const Vec3 carried = may_be_stopped(a) || may_be_stopped(b) ? Vec3(Vec3::Zero()) : ways_[a].mean;
  return surface_of(a).may_meet(surface_of(b), margin, carried) || is_within(a, b) || is_within(b, a);
}

// Tells whether a body begins the step wholly within another one; their surfaces may be far from each other.
bool IslandFinder::is_within(std::size_t inner, std::size_t outer) const {
  const Model& model = bodies_[inner]->model();
  if (!bodies_[outer]->model().parts.front().solid) return false;
  const Bounds &own = surface_of(inner).bounds_at_start(), &other = surface_of(outer).bounds_at_start();
  if ((own.lower.array() < other.lower.array()).any() || (own.upper.array() > other.upper.array()).any()) return false;
  const Vec3 point = bodies_[inner]->state().x.row(model.surface(0, 0));
  const auto place = surface_of(outer).closest_at_start(point, bodies_[outer]->model().size);
  return place && place->distance < 0;
}

// Tells whether a body may come to a collider on its way; a collider that moves counts wherever it is.
bool IslandFinder::may_be_stopped(std::size_t body) const {
  const StepInputs& inputs = bodies_[body]->inputs();
  const Vec3 center = ways_[body].swept.center();
  const double radius = 0.5 * ways_[body].swept.diagonal();
  for (std::size_t c = 0; c < collider_count(inputs); ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    const ColliderMotion& motion = inputs.collider_motions[c];
    if (motion.moves()) return true;
    const double distance = collider.shape.distance(motion.start.inverse() * center);
    if (collider.shape.certainty() * distance - collider.thickness <= radius) return true;
  }
  return false;
}

std::vector<std::vector<std::size_t>> IslandFinder::find() {
  const std::size_t count = bodies_.size();
  DisjointSets groups(count);
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (meet(scene_, a, b)) pairs.push_back({a, b});
    }
  }
  if (pairs.empty()) return lists_of(groups);
  const Zone zone("islands");
  find_ways();
  // The bodies of an island may push each other off their ways, by as much as their ways differ, and so into others.
  std::vector<double> pushed(count, 0.0);
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [a, b] : pairs) {
      if (groups.of(a) == groups.of(b) || !may_touch(a, b, pushed[a] + pushed[b])) continue;
      groups.join(a, b);
      grows = true;
    }
    for (const std::vector<std::size_t>& island : lists_of(groups)) {
      double most = 0;
      for (const std::size_t a : island) most = std::max(most, (ways_[a].mean - ways_[island.front()].mean).norm());
      for (const std::size_t a : island) pushed[a] = most;
    }
  }
  return lists_of(groups);
}

}  // namespace supple
