#include "film/record/world_errors.h"

#include <algorithm>
#include <utility>

#include "base/trace.h"
#include "sim/model/joined_model.h"

namespace supple {

std::optional<MeasuredErrors> WorldErrors::of_step(std::size_t body) {
  const MovingBody& moved = world_.body(body);
  if (!bodies_[body].found) {
    if (!moved.is_in_island()) {
      measure_alone(body);
    } else if (world_.joined_step().bodies.front() == body) {
      measure_joined(world_.joined_step());
    }
  }
  return std::exchange(bodies_[body].found, std::nullopt);
}

void WorldErrors::measure_alone(std::size_t body) {
  const MovingBody& moved = world_.body(body);
  if (moved.untangled()) return;
  const Zone zone("reference error", moved.body().def.name);
  OfBody& of = bodies_[body];
  if (of.metered_model != moved.model().id) of.meter = solvers_.error_meter(moved.model(), threads_);
  of.metered_model = moved.model().id;
  of.found = of.meter->step_errors(moved.model(), moved.inputs(), of.before, moved.state());
}

void WorldErrors::measure_joined(const JoinedStep& step) {
  const auto is_untangled = [this](std::size_t body) { return world_.body(body).untangled(); };
  if (std::ranges::any_of(step.bodies, is_untangled)) return;
  const Zone zone("reference error", world_.body(step.bodies.front()).body().def.name);
  const Model& joined = *step.model;
  State before, after;
  for (State* state : {&before, &after}) {
    state->x.resize(joined.vertices, 3);
    state->v.resize(joined.vertices, 3);
  }
  for (std::size_t p = 0; p < step.bodies.size(); ++p) {
    const State &first = bodies_[step.bodies[p]].before, &last = world_.body(step.bodies[p]).state();
    set_rows(joined.parts[p], first.x, before.x);
    set_rows(joined.parts[p], first.v, before.v);
    set_rows(joined.parts[p], last.x, after.x);
    set_rows(joined.parts[p], last.v, after.v);
    before.time = first.time;
    after.time = last.time;
  }
  const std::vector<MeasuredErrors> errors = solvers_.joined_errors(joined, *step.inputs, before, after, threads_);
  for (std::size_t p = 0; p < step.bodies.size(); ++p) bodies_[step.bodies[p]].found = errors[p];
}

}  // namespace supple
