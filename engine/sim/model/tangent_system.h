// Makes a matrix for search directions that follows the body, where A = M/h^2 + L has one stiffness for each material.
// Its part S is what the Hessian of g at given positions has in common for x, y and z: S_ij = tr(H_ij) / 3 over the
// projected Hessian's blocks (elements/tetrahedron_scalar_stiffness.h). It has A's pattern, so that it is factored and
// solved like A, and it does not change when the body turns. docs/method.md ("A matrix that follows the body") says
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

  // Makes the matrix at x (n x 3 in the model's order) and factors it; does nothing where the matrix at x is there
  // already. The bits do not depend on threads. Allocates only when the model's structure is not that of the last call.
  // Returns false, and leaves no matrix, when it is not positive definite, as when positions or stiffnesses are too
  // large for numbers.
  bool make(const Model& model, const Positions& x, const TangentShares& shares, Threads* threads);

  // Returns how far the elements' stiffness at x is from their stiffness where the matrix was made
  // (stiffness_sample.h).
  double departure(const Model& model, const Positions& x) const;

  const System& system() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace supple
