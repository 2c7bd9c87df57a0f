// Makes turns of straight motions. Where parts of a body turn, a straight motion d stretches them by half the square of
// the angle, which costs a stiff body more energy than all else in a step. The correction e leads to where the edges of
// the body turn and keep their lengths, as near as inertia lets them: it minimises
//
//   1/2 |e|^2_M / h^2 + 1/2 sum over edges of -L_ij |e_i - e_j - C_ij (x_i - x_j)|^2,   C_ij = R_ij - 1 - [theta_ij]x
//
// which is the global step of Projective Dynamics (Bouaziz, Martin, Liu, Kavan, Pauly 2014) with rotations R that are
// read from the motion in place of those of the elements, and takes one solve with A. theta is the angle by which the
// clusters of the body turn in the motion (coarse_system.h).
#pragma once

#include "sim/coarse/coarse_system.h"
#include "sim/model/system_solve.h"

namespace supple {

class Turning {
 public:
  // Allocates memory for a model, so that the other functions allocate nothing.
  void prepare(const Model& model) {
    by_vertex_.resize(model.vertices);
    right_.resize(model.free, 3);
  }

  // Takes the motion h v from the start of a step. Backward Euler's velocities are along the chord of the step before.
  // A motion along a chord would widen a part that turns; the function takes this widening out of the motion.
  void take_velocity(const CoarseSystem& system, const Positions& x, const Positions& motion);
  // Takes a motion from x as the tangent of the turning.
  void take_tangent(const CoarseSystem& system, const Positions& x, const Positions& motion);

  // Returns roughly the energy that it takes to stretch what turns along the straight motion [J].
  double energy() const;
  // Returns the share that one part of the model has in this energy [J].
  double energy_of(std::size_t part) const { return part < energy_.size() ? energy_[part] : 0; }

  // Computes e (n_free x 3).
  void correct(const Model& model, const CoarseSystem& system, const Positions& x, SolveScratch& scratch,
               Positions& correction);

 private:
  std::vector<ClusterTurn> turns_;
  std::vector<Mat3> by_cluster_, by_vertex_;  // C, by cluster and by vertex
  std::vector<double> energy_;                // by part of the model; empty without clusters
  Positions right_;
};

}  // namespace supple
