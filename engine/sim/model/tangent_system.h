// Makes a matrix for search directions that follows the body, where A = M/h^2 + L has one stiffness for each material.
// Its part S takes from the Hessian of g at given positions what is the same for x, y and z: S_ij = tr(H_ij) / 3 over
// the projected Hessian's blocks (elements/tetrahedron_scalar_stiffness.h). It has A's pattern, so that it is factored
// and solved like A, and it does not change when the body turns. docs/method.md ("A matrix that follows the body") says
// what it gains. Not here: when it is renewed (solver/matrix_rule.h).
#pragma once

#include <memory>

#include "base/threads.h"
#include "sim/model/model.h"
#include "sim/model/stiffness_sample.h"

namespace supple {

class TangentSystem {
 public:
  TangentSystem();
  ~TangentSystem();
  TangentSystem(TangentSystem&&) noexcept;
  TangentSystem& operator=(TangentSystem&&) noexcept;

  // Makes the matrix at x (n x 3 in the model's order) and factors it; does nothing where that is done already. The
  // bits do not depend on threads. Allocates only for another structure than last time. Returns false when the matrix
  // is not positive definite, as where positions or stiffnesses are too large for numbers; there is none then.
  bool make(const Model& model, const Positions& x, const TangentShares& shares, Threads* threads);

  // How far the elements' stiffness at x is from that where the matrix was made (stiffness_sample.h).
  double departure(const Model& model, const Positions& x) const;

  const System& system() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
