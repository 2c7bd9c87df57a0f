// Computes directions of Newton's method: from the Hessian of g at the current iterate, contacts included, with each
// element's part projected to be positive semi-definite. It is factored anew for each direction, which costs as much as
// 20 to 200 evaluations, so only hard steps use it (newton_finish.h).
#pragma once

#include <memory>

#include "sim/model/inputs.h"
#include "sim/model/model.h"

namespace supple {

struct OpenWorkspace;

class NewtonSystem {
 public:
  NewtonSystem();
  ~NewtonSystem();
  NewtonSystem(NewtonSystem&&) noexcept;
  NewtonSystem& operator=(NewtonSystem&&) noexcept;

  // Sets workspace.direction at workspace.current; returns tr(grad^T d) [J]. Near planes that the direction would lead
  // through hold it back, as in foresee_contacts() (contact_direction.h). Allocates only when the model's structure is
  // not that of the last call. Where the numbers are too large for a factor or its solution, the direction is zero.
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Returns about how many evaluations of the body's elements one such direction costs, by counts alone.
double newton_cost(const Model& model);

}  // namespace supple
