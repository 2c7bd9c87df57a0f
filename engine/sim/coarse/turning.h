// Makes turns of straight motions. Where parts of a body turn, a straight motion d stretches them by half the square of
// the angle, which costs a stiff body more energy than all else in a step. The correction e leads to where the edges of
// the body turn and keep their lengths, as near as inertia lets them: it minimises
//
//   1/2 |e|^2_M / h^2 + 1/2 sum over edges of -L_ij |e_i - e_j - C_ij (x_i - x_j)|^2,   C_ij = R_ij - 1 - [theta_ij]x
//
// which is the global step of Projective Dynamics (Bouaziz, Martin, Liu, Kavan, Pauly 2014) with the rotations R that
// the motion tells in place of those that elements have, and takes one solve with A. theta: by what the clusters of
// the body turn in the motion (coarse_system.h).
#pragma once

#include "sim/coarse/coarse_system.h"
#include "sim/model/system_solve.h"

namespace supple {

class Turning {
 public:
  // Allocates memory for a model, so that what follows allocates nothing.
  void prepare(const Model& model) {
    by_vertex_.resize(model.vertices);
    right_.resize(model.free, 3);
  }

  // Takes the motion h v from the start of a step. The velocities of backward Euler are those of the chord of the step
  // before: where a part turned, they seem to widen it, too, which is taken out again.
  void take_velocity(const CoarseSystem& system, const Positions& x, const Positions& motion);
  // Takes a motion from x that is to be a tangent.
  void take_tangent(const CoarseSystem& system, const Positions& x, const Positions& motion);

  // Returns about the energy that the straight motion takes by stretching what turns [J].
  double energy() const { return energy_; }

  // Computes e (n_free x 3).
  void correct(const Model& model, const CoarseSystem& system, const Positions& x, SolveScratch& scratch,
               Positions& correction);

 private:
  std::vector<CoarseSystem::Turn> turns_;
  std::vector<Mat3> by_cluster_, by_vertex_;  // C
  double energy_ = 0;
  Positions right_;
};

}  // namespace supple
