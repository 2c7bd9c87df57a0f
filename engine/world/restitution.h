// Gives bodies back what a step of the film takes from their bounce. Soft bodies bounce by their own elasticity, but
// backward Euler loses nearly all of what swings within a body; a scene can ask for the share of its speed that a body
// keeps at least (`contact.restitution` of a body, `restitution` of a collider).
//
// The law is Newton's: two bodies leave each other at least at the speed with which they came together, times the
// coefficient. As in Poisson's law (Stronge 2000, "Impact Mechanics", section 3.2.2), this takes as long as their
// coming together. What counts is their motion as a whole (rigid_motion.h) at the place where they touch, along the
// mean normal there. Each step of the approach takes a share of their speed. Once they no longer come together, the
// steps that follow give these shares back in the reverse order, times the coefficient: a stiff ball leaves the ground
// at once, and a soft one takes as long as it took to be pressed flat. What elasticity gives by itself in these steps
// is not given a second time. The gift is an impulse on both bodies, at the place where they touch, with the friction
// that belongs to it; so momentum is kept, and a bar that lands on its end begins to turn. Impulses of all that touch
// in an island are found together: many tiles are as one floor, and a ball bounces off a light mat that lies on the
// ground. The energy is counted (Bounces::given).
//
// Bodies bounce only if they come together faster than a threshold: the speed that gravity gives in two steps, plus a
// hundredth of the body's size in a second. Otherwise nothing would come to rest (Mueller, Macklin, Chentanez, Jeschke,
// Kim 2020, "Detailed rigid body simulation with extended position based dynamics", section 3.6, has the first part).
#pragma once

#include <memory>
#include <vector>

#include "sim/solver/rigid_motion.h"
#include "world/body_touch.h"
#include "world/moving_body.h"

namespace supple {

struct SceneDef;

class Restitution {
 public:
  // Both must outlive this object. bodies: those of the scene, in its order.
  Restitution(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies);

  // Lets the bodies of an island bounce: the first function is to be called before each step of the island, the second
  // after it. Both do nothing where nothing bounces. Different islands may make their steps at the same time. touches:
  // those of this island's step, and maybe of others.
  void before_step(const std::vector<std::size_t>& island);
  void after_step(const std::vector<std::size_t>& island, const std::vector<BodyTouch>& touches);

 private:
  struct Touching;
  struct Push;
  using Motions = std::vector<RigidMotion>;  // by body

  bool may_bounce(const std::vector<std::size_t>& island) const;
  double coefficient(std::size_t owner, const Bounce& bounce) const;
  double friction(std::size_t owner, const Bounce& bounce) const;
  bool falls(std::size_t body) const;
  double gravity_between(std::size_t owner, const Bounce& bounce) const;
  Vec3 velocity_between(std::size_t owner, const Bounce& bounce, const Motions& motions) const;

  Bounce place_of(std::size_t owner, const Touching& touching) const;
  std::vector<Touching> touchings(std::size_t owner, const std::vector<BodyTouch>& touches) const;
  void go_on(std::size_t owner, const std::vector<std::size_t>& island, const std::vector<Touching>& touchings);
  bool approach(std::size_t owner, Bounce& bounce, double gained, double speed) const;
  double goal_of(std::size_t owner, Bounce& bounce) const;
  std::vector<Push> pushes(const std::vector<std::size_t>& island, const std::vector<std::vector<Touching>>& touched);
  void solve(std::vector<Push>& all);
  void rub(const std::vector<Push>& all);
  void set_velocities(std::size_t body, const RigidMotion& stepped);

  const SceneDef& scene_;
  const std::vector<std::unique_ptr<MovingBody>>& bodies_;
  Motions before_, after_;  // of the step
};

}  // namespace supple
