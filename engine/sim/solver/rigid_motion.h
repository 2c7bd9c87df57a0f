// Finds how a body moves as a whole: the rigid motion that is nearest to the velocities of its vertices, by a
// least-squares fit with the masses as weights, as in Mueller, Heidelberger, Hennix, Ratcliff 2007, "Position based
// dynamics", section 3.5. It has the linear and the angular momentum of a body that nothing holds. Where handles hold
// vertices, these count a million times as much, so that the rigid motion goes with them: a body on a hinge swings
// about it, and one that is clamped stays.
#pragma once

#include <Eigen/Geometry>

#include "sim/model/model.h"

namespace supple {

// Holds the velocity of a rigid body, and how it resists a push.
struct RigidMotion {
  double mass = 0;              // the sum of the weights [kg]
  Mat3 inertia = Mat3::Zero();  // about the centre [kg m^2]
  Vec3 center = Vec3::Zero();   // centre of the weights, which is that of mass where nothing is held [m]
  Vec3 linear = Vec3::Zero();   // velocity of the centre [m/s]
  Vec3 angular = Vec3::Zero();  // [rad/s]

  // Returns the velocity of a place that goes with the body [m/s].
  Vec3 at(const Vec3& place) const { return linear + angular.cross(place - center); }
  // Returns how an impulse [N s] at a place changes the angular velocity [rad/s]. arm: from the centre to the place
  // [m].
  Vec3 turn_by(const Vec3& impulse, const Vec3& arm) const;
};

// Returns the rigid motion of a body. x: positions, n x 3, in the model's order [m]; v: velocities, n x 3 [m/s].
RigidMotion rigid_motion(const Model& model, const Positions& x, const Positions& v);

}  // namespace supple
