// Defines a matrix for search directions that couples coordinates, 3n x 3n: the turned Hessian, which is the Hessian of
// g in some pose of the body, with each element's part projected, and turns with the body. As the body moves on, only
// the stiffness in the matrix gets old, and where the body merely turns and bends, it does not. The first iteration of
// Newton's method would solve with the same matrix; here the matrix is factored once for many frames. docs/method.md
// ("A matrix that follows the body") says what it gains. Not here: when it is renewed (solver/matrix_rule.h); contacts,
// which the matrix does not contain.
#pragma once

#include <memory>

#include "base/threads.h"
#include "sim/model/model.h"

namespace supple {

class TurnedHessianSystem {
 public:
  TurnedHessianSystem();
  ~TurnedHessianSystem();
  TurnedHessianSystem(TurnedHessianSystem&&) noexcept;
  TurnedHessianSystem& operator=(TurnedHessianSystem&&) noexcept;

  // Makes the matrix at x (n x 3 in the model's order) and factors it, in the precision of the model's factor; does
  // nothing where the matrix at x is there already. The bits do not depend on threads (may be null). Allocates only
  // when the model's structure is not that of the last call. Returns false, and leaves no matrix, when it is not
  // positive definite, as when positions or stiffnesses are too large for numbers.
  bool make(const Model& model, const Positions& x, Threads* threads);

  // Returns how far the elements' stiffness at x is from their stiffness where the matrix was made
  // (stiffness_sample.h).
  double departure(const Model& model, const Positions& x) const;

  // Turns the matrix at each vertex by what the elements around it have turned between where it was made and x.
  void turn_to(const Positions& x, Threads* threads);

  // Computes z = H^-1 r for the turned matrix, both n_free x 3 [m], [N]. Where nothing holds the body, its centre of
  // mass moves as Newton's law says.
  void solve(const Model& model, const Positions& r, Positions& z);

  // Returns about how many evaluations of the body's elements a renewal costs, by counts of operations alone.
  double renewal_cost(const Model& model) const;

  // Counts the numbers of the factor.
  std::int64_t stored_numbers() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Returns about how many evaluations of the body's elements it costs to compute the elements' Hessians and to factor
// their sum with so many operations, by counts of operations alone.
double cost_of_hessian(const Model& model, double factor_operations);

}  // namespace supple
