#include "world/restitution.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/trace.h"
#include "scene/definition/meeting.h"
#include "scene/definition/scene_def.h"
#include "sim/contact/find_contacts.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Tells where and how a body touches a collider or a body that comes later in the scene.
struct Restitution::Touching {
  std::int32_t collider = -1, body = -1;
  Vec3 push = Vec3::Zero();   // on the body [N]
  double pressing = 0;        // sum of the sizes of the forces [N]
  Vec3 place = Vec3::Zero();  // mean of the places that touch, weighted by force [m]
  Vec3 way = Vec3::Zero();    // mean way of these places in the step, relative to the collider [m]
  // The places that touch a collider and are furthest along x, y, z, -x, -y, -z [m].
  std::array<Vec3, 6> corners = {};

  bool is_of(const Bounce& bounce) const { return collider == bounce.collider && body == bounce.body; }
};

Restitution::Restitution(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies)
    : scene_(scene), bodies_(bodies), before_(bodies.size()), after_(bodies.size()) {}

bool Restitution::may_bounce(const std::vector<std::size_t>& island) const {
  const auto bounces = [](const auto& contact) { return contact.restitution > 0; };
  const auto is_in_bounce = [&](std::size_t b) { return !bodies_[b]->state_.bounces.begun.empty(); };
  return std::ranges::any_of(scene_.colliders, bounces) || std::ranges::any_of(island, is_in_bounce) ||
         std::ranges::any_of(island, [&](std::size_t b) { return bounces(scene_.bodies[b].contact); });
}

double Restitution::coefficient(std::size_t owner, const Bounce& bounce) const {
  const BodyDef& body = scene_.bodies[owner];
  return bounce.body >= 0 ? pair_restitution(body, scene_.bodies[bounce.body])
                          : pair_restitution(body, scene_.colliders[bounce.collider]);
}

double Restitution::friction(std::size_t owner, const Bounce& bounce) const {
  return bounce.body >= 0 ? pair_friction(scene_.bodies[owner], scene_.bodies[bounce.body])
                          : scene_.colliders[bounce.collider].friction;
}

// Tells whether a body falls as a whole: nothing holds it.
bool Restitution::falls(std::size_t body) const {
  const Model& model = bodies_[body]->model();
  const auto is_held = [](double stiffness) { return stiffness > 0; };
  return model.free == model.vertices && std::ranges::none_of(model.handle_stiffness, is_held);
}

// Returns the acceleration by which gravity drives the two sides together; it is 0 where both fall [m/s^2].
double Restitution::gravity_between(std::size_t owner, const Bounce& bounce) const {
  const double falling = (falls(owner) ? 1 : 0) - (bounce.body >= 0 && falls(bounce.body) ? 1 : 0);
  return std::max(0.0, -falling * bounce.normal.dot(scene_.gravity));
}

// Returns how the body moves against the other side where the two touch [m/s].
Vec3 Restitution::velocity_between(std::size_t owner, const Bounce& bounce, const Motions& motions) const {
  const Vec3 own = motions[owner].at(motions[owner].center + bounce.arm);
  if (bounce.body >= 0) return own - motions[bounce.body].at(motions[bounce.body].center + bounce.other_arm);
  const MovingBody& body = *bodies_[owner];
  const Vec3 place = after_[owner].center + bounce.arm;
  return own - (carried_by(body.inputs(), bounce.collider, place) - place) / body.model().time_step;
}

void Restitution::before_step(const std::vector<std::size_t>& island) {
  if (!may_bounce(island)) return;
  for (const std::size_t b : island)
    before_[b] = rigid_motion(bodies_[b]->model(), bodies_[b]->state_.x, bodies_[b]->state_.v);
}

std::vector<Restitution::Touching> Restitution::touchings(std::size_t owner,
                                                          const std::vector<BodyTouch>& touches) const {
  std::vector<Touching> result;
  const MovingBody& body = *bodies_[owner];
  const Positions &x = body.state_.x, &v = body.state_.v;
  for (const Contact& contact : bodies_[owner]->workspace().current.contacts) {
    const double pressing = -2 * contact.stiffness * std::min(0.0, gap(contact, x));
    if (!contact.other.is_collider() || pressing <= 0) continue;
    auto at = std::ranges::find(result, contact.other.collider, &Touching::collider);
    if (at == result.end()) at = result.insert(at, {.collider = contact.other.collider});
    const Vec3 place = contact.stencil.at(x), carried = carried_by(body.inputs(), at->collider, place) - place;
    for (int k = 0; k < 6; ++k) {
      const double sign = k < 3 ? 1 : -1;
      Vec3& corner = at->corners[std::size_t(k)];
      if (at->pressing == 0 || sign * place[k % 3] > sign * corner[k % 3]) corner = place;
    }
    at->push += pressing * contact.normal;
    at->pressing += pressing;
    at->place += pressing * place;
    at->way += pressing * (body.model().time_step * contact.stencil.at(v) - carried);
  }
  for (Touching& touching : result) {
    touching.place /= touching.pressing;
    touching.way /= touching.pressing;
  }
  for (const BodyTouch& touch : touches) {
    if (touch.a != owner || touch.b == owner || touch.pressing <= 0) continue;
    result.push_back({.body = static_cast<std::int32_t>(touch.b),
                      .push = -touch.force,
                      .pressing = touch.pressing,
                      .place = touch.place});
  }
  // Pushes from all sides, as of a ring that is threaded on a bar, have no direction in which to bounce.
  constexpr double least_direction = 0.3;  // of the sum of the forces' sizes
  std::erase_if(result, [](const Touching& t) { return t.push.norm() < least_direction * t.pressing; });
  return result;
}

// Notes what a step takes of the approach, and lets the two begin to leave when the approach is over. gained: by how
// much they come together more slowly after the step than before it; speed: with which they go apart after it [m/s].
// Returns false where they do not bounce.
bool Restitution::approach(std::size_t owner, Bounce& bounce, double gained, double speed) const {
  constexpr double stopped = 0.1;  // of the approach: contact stops the rest of it in many steps
  const Model& model = bodies_[owner]->model();
  bounce.shares.push_back(std::max(0.0, gained));
  bounce.sunk += model.time_step * std::max(0.0, -speed);
  if (speed < -stopped * bounce.approach) return true;
  const double gravity = gravity_between(owner, bounce), kept = coefficient(owner, bounce);
  if (kept == 0) return false;
  // Gravity goes on driving the two together while one is pressed flat, and this counts as approach too. A step of
  // backward Euler has the velocity of its middle, and gravity has half a step to slow the two down until then.
  const double half_a_step = model.scheme.theta == 1 ? 0.5 * model.time_step : 0;
  bounce.target =
      kept * std::hypot(bounce.approach, std::sqrt(2 * gravity * std::max(0.0, bounce.sunk))) + half_a_step * gravity;
  double taken = 0;
  for (const double share : bounce.shares) taken += share;
  if (taken <= 0 || bounce.target <= speed) return false;
  for (double& share : bounce.shares) share *= (bounce.target - speed) / taken;
  return bounce.is_leaving = true;
}

// Describes an impulse between two that touch, and how it changes their motions.
struct Restitution::Push {
  std::size_t owner;
  Bounce at;           // of which the sides, the normal and the arms are read
  double goal;         // the least speed with which the two shall go apart [m/s]
  double impulse = 0;  // so far [N s]

  // Changes the motions by an impulse on the owner, and the opposite one on the other side [N s].
  void add(const Vec3& change, Motions& motions) const {
    RigidMotion& own = motions[owner];
    own.linear += change / own.mass;
    own.angular += own.turn_by(change, at.arm);
    if (at.body < 0) return;
    RigidMotion& other = motions[std::size_t(at.body)];
    other.linear -= change / other.mass;
    other.angular -= other.turn_by(change, at.other_arm);
  }
  // Returns the mass that an impulse has to move along a direction of length 1 [kg].
  double mass_along(const Vec3& direction, const Motions& motions) const {
    const RigidMotion& own = motions[owner];
    Vec3 change = direction / own.mass + own.turn_by(direction, at.arm).cross(at.arm);
    if (at.body >= 0) {
      const RigidMotion& other = motions[std::size_t(at.body)];
      change += direction / other.mass + other.turn_by(direction, at.other_arm).cross(at.other_arm);
    }
    return 1 / direction.dot(change);
  }
};

// Takes from a bounce what is due after this step, and returns how fast the two shall go apart now [m/s].
double Restitution::goal_of(std::size_t owner, Bounce& bounce) const {
  const double due = bounce.shares.back(), given_already = std::min(bounce.ahead, due);
  bounce.shares.pop_back();
  bounce.ahead -= given_already;
  const double speed = bounce.normal.dot(velocity_between(owner, bounce, after_));
  return std::max(speed, std::min(speed + due - given_already, bounce.target));
}

// Returns a push for each bounce that leaves, with what is due to it as its goal, and for all else that touches in the
// step, such as a mat on the ground off which a ball bounces: these shall not come together faster. Cloth, which has no
// motion as a whole, is left out. Empty where no bounce leaves.
std::vector<Restitution::Push> Restitution::pushes(const std::vector<std::size_t>& island,
                                                   const std::vector<std::vector<Touching>>& touched) {
  std::vector<Push> all;
  bool any = false;
  for (const std::size_t b : island) {
    for (Bounce& bounce : bodies_[b]->state_.bounces.begun) {
      if (!bounce.is_leaving) continue;
      any = true;
      all.push_back({b, bounce, goal_of(b, bounce)});
    }
  }
  if (!any) return {};
  const std::size_t leaving = all.size();
  const auto is_cloth = [&](std::int64_t body) {
    return body >= 0 && scene_.bodies[std::size_t(body)].cloth.has_value();
  };
  for (std::size_t m = 0; m < island.size(); ++m) {
    const std::size_t b = island[m];
    for (const Touching& touching : touched[m]) {
      if (is_cloth(std::int64_t(b)) || is_cloth(touching.body)) continue;
      const auto is_of = [&](const Push& push) { return push.owner == b && touching.is_of(push.at); };
      if (std::any_of(all.begin(), all.begin() + std::ptrdiff_t(leaving), is_of)) continue;
      Bounce at = place_of(b, touching);
      const auto hold = [&] { all.push_back({b, at, std::min(0.0, at.normal.dot(velocity_between(b, at, after_)))}); };
      if (touching.body >= 0) hold();
      for (std::size_t k = 0; touching.body < 0 && k < touching.corners.size(); ++k) {
        at.arm = touching.corners[k] - after_[b].center;
        hold();
      }
    }
  }
  return all;
}

// Finds impulses along the normals that are nowhere below 0 and bring all pairs to their goals, and no pair beyond its
// goal where there is an impulse: projected Gauss-Seidel, as in Jourdan, Alart, Jean 1998, "A Gauss-Seidel like
// algorithm to solve frictional contact problems". So a floor of many tiles is as one floor.
void Restitution::solve(std::vector<Push>& all) {
  constexpr int most_rounds = 200;
  constexpr double small = 1e-6;  // of the largest change of speed in the first round
  std::vector<double> mass;
  for (const Push& push : all) mass.push_back(push.mass_along(push.at.normal, after_));
  double first = 0;
  for (int round = 0; round < most_rounds; ++round) {
    double largest = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Push& push = all[i];
      const double short_of = push.goal - push.at.normal.dot(velocity_between(push.owner, push.at, after_));
      const double change = std::max(-push.impulse, short_of * mass[i]);
      push.add(change * push.at.normal, after_);
      push.impulse += change;
      largest = std::max(largest, std::abs(change / mass[i]));
    }
    if (round == 0) first = largest;
    if (largest <= small * first) break;
  }
}

// Lets friction oppose the slip by what the impulses along the normals allow, and stop it at most.
void Restitution::rub(const std::vector<Push>& all) {
  for (const Push& push : all) {
    const Vec3 velocity = velocity_between(push.owner, push.at, after_);
    const Vec3 slip = velocity - velocity.dot(push.at.normal) * push.at.normal;
    if (push.impulse <= 0 || slip.isZero(0)) continue;
    const Vec3 along = slip.normalized();
    const double stopping = slip.norm() * push.mass_along(along, after_);
    push.add(-std::min(friction(push.owner, push.at) * push.impulse, stopping) * along, after_);
  }
}

// Returns where and how a body touches something, as a bounce has it.
Bounce Restitution::place_of(std::size_t owner, const Touching& touching) const {
  Bounce at{.collider = touching.collider, .body = touching.body};
  at.normal = touching.push.normalized();
  at.arm = touching.place - after_[owner].center;
  if (touching.body >= 0) at.other_arm = touching.place - after_[std::size_t(touching.body)].center;
  return at;
}

// Begins the bounces of a body, and goes on with those that have begun. A bounce off a body that is too far away to be
// in the island is over.
void Restitution::go_on(std::size_t owner, const std::vector<std::size_t>& island,
                        const std::vector<Touching>& touchings) {
  const Model& model = bodies_[owner]->model();
  std::vector<Bounce>& begun = bodies_[owner]->state_.bounces.begun;
  for (const Touching& touching : touchings) {
    auto bounce = std::ranges::find_if(begun, [&](const Bounce& one) { return touching.is_of(one); });
    const Bounce at = place_of(owner, touching);
    if (bounce != begun.end()) {
      bounce->normal = at.normal;
      bounce->arm = at.arm;
      bounce->other_arm = at.other_arm;
      continue;
    }
    bounce = begun.insert(bounce, at);
    const double gravity = gravity_between(owner, *bounce), step = model.time_step;
    const double speed = -bounce->normal.dot(velocity_between(owner, *bounce, before_));
    constexpr double creeping = 0.01;  // body sizes in a second: what rests, or is pressed to rest, moves by less
    if (speed <= 2 * step * scene_.gravity.norm() + creeping * model.size || coefficient(owner, *bounce) == 0) {
      begun.erase(bounce);
      continue;
    }
    const double at_start = speed + (model.scheme.theta == 1 ? 0.5 * step * gravity : 0);
    const double fallen = std::max(0.0, -bounce->normal.dot(touching.way));
    bounce->approach = std::hypot(at_start, std::sqrt(2 * gravity * fallen));
    bounce->sunk = -fallen;
  }
  std::erase_if(begun, [&](Bounce& bounce) {
    if (bounce.body >= 0 && std::ranges::find(island, std::size_t(bounce.body)) == island.end()) return true;
    const bool touches = std::ranges::any_of(touchings, [&](const Touching& t) { return t.is_of(bounce); });
    const double was = bounce.normal.dot(velocity_between(owner, bounce, before_));
    const double is = bounce.normal.dot(velocity_between(owner, bounce, after_));
    if (bounce.is_leaving) {
      if (touches) bounce.ahead += std::max(0.0, is - was);
    } else if (!touches || !approach(owner, bounce, is - was, is)) {
      return true;
    }
    return false;
  });
}

// Adds what the impulses have changed of a body's rigid motion to its velocities. stepped: its rigid motion after the
// step, without the impulses.
void Restitution::set_velocities(std::size_t body, const RigidMotion& stepped) {
  RigidMotion change = after_[body];
  change.linear -= stepped.linear;
  change.angular -= stepped.angular;
  if (change.linear.isZero(0) && change.angular.isZero(0)) return;
  const Model& model = bodies_[body]->model();
  State& state = bodies_[body]->state_;
  for (int i = 0; i < model.free; ++i) {
    const Vec3 added = change.at(state.x.row(i).transpose()), before = state.v.row(i);
    state.bounces.given += model.mass[i] * added.dot(before + 0.5 * added);
    state.v.row(i) += added.transpose();
  }
}

void Restitution::after_step(const std::vector<std::size_t>& island, const std::vector<BodyTouch>& touches) {
  if (!may_bounce(island)) return;
  const Zone zone("restitution");
  std::vector<RigidMotion> stepped;
  for (const std::size_t b : island) {
    after_[b] = rigid_motion(bodies_[b]->model(), bodies_[b]->state_.x, bodies_[b]->state_.v);
    stepped.push_back(after_[b]);
  }
  std::vector<std::vector<Touching>> touched;  // by member of the island
  for (const std::size_t b : island) touched.push_back(touchings(b, touches));
  for (std::size_t m = 0; m < island.size(); ++m) go_on(island[m], island, touched[m]);
  std::vector<Push> all = pushes(island, touched);
  solve(all);
  rub(all);
  for (const std::size_t b : island) {
    const auto is_over = [](const Bounce& bounce) { return bounce.is_leaving && bounce.shares.empty(); };
    std::erase_if(bodies_[b]->state_.bounces.begun, is_over);
  }
  for (std::size_t m = 0; m < island.size(); ++m) set_velocities(island[m], stepped[m]);
}

}  // namespace supple
