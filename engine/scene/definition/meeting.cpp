#include "scene/definition/meeting.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "scene/definition/body_def.h"
#include "scene/definition/collider_def.h"
#include "scene/definition/scene_def.h"

namespace supple {
namespace {

bool integrators_differ(const BodyDef& a, const BodyDef& b) { return a.solver.integrator != b.solver.integrator; }

bool factors_differ(const BodyDef& a, const BodyDef& b) { return a.solver.precision != b.solver.precision; }

bool allows_meeting(const BodyDef& body, const BodyDef& other) {
  return !body.contact.meets || asks_to_meet(body, other);
}

}  // namespace

bool asks_to_meet(const BodyDef& body, const BodyDef& other) {
  const auto is_other = [&other](const std::string& name) { return name == other.name || name == other.table; };
  return body.contact.meets && std::ranges::any_of(*body.contact.meets, is_other);
}

bool both_allow_meeting(const BodyDef& a, const BodyDef& b) { return allows_meeting(a, b) && allows_meeting(b, a); }

std::string why_not_meet(const BodyDef& a, const BodyDef& b) {
  if (integrators_differ(a, b))
    return fmt::format("bodies that meet need the same solver.integrator, and these have '{}' and '{}'",
                       name_of(a.solver.integrator), name_of(b.solver.integrator));
  if (factors_differ(a, b))
    return fmt::format("bodies that meet need the same solver.factor, and these have '{}' and '{}'",
                       name_of(a.solver.precision), name_of(b.solver.precision));
  return "";
}

bool meet(const BodyDef& a, const BodyDef& b) {
  return !integrators_differ(a, b) && !factors_differ(a, b) && both_allow_meeting(a, b);
}

bool meet(const SceneDef& scene, std::size_t a, std::size_t b) {
  return a != b && meet(scene.bodies.at(a), scene.bodies.at(b));
}

bool meets_itself(const BodyDef& body) { return body.contact.self; }

double pair_friction(const BodyDef& a, const BodyDef& b) { return std::sqrt(a.contact.friction * b.contact.friction); }

double pair_restitution(const BodyDef& a, const BodyDef& b) {
  return a.cloth || b.cloth ? 0 : std::max(a.contact.restitution, b.contact.restitution);
}

double pair_restitution(const BodyDef& body, const ColliderDef& collider) {
  return body.cloth ? 0 : std::max(body.contact.restitution, collider.restitution);
}

}  // namespace supple
