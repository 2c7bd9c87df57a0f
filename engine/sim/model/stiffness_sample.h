// Tells how far the elements' stiffness is from where a matrix was made of it, and so when to make a matrix anew.
#pragma once

#include "base/aligned.h"
#include "sim/model/model.h"

namespace supple {

// The shares of S and A in the matrix. A tangent looks at a point, but a step needs an interval: A, whose stiffness is
// fitted over one, keeps directions short where a material has next to no stiffness as it is but stiffens as it goes.
struct TangentShares {
  double tangent = 0.9;
  double constant = 0.1;
  double axial = 0.7;  // S is along each principal axis at least this share of the secant stiffness there
  bool operator==(const TangentShares&) const = default;
};

// Holds the stiffness of a sample of the elements, those of every eighth chunk, as scalar_stiffness() finds it
// (elements/element_kernels.h): it does not change when an element turns.
class StiffnessSample {
 public:
  // Allocates for the structure of this model.
  explicit StiffnessSample(const Model& model);

  // Takes the sample at x (n x 3 in the model's order).
  void take(const Model& model, const Positions& x, const TangentShares& shares);

  // Sums the changes of the elements' stiffness since, over the sum of what is in the matrix. 0 where all but turned.
  double departure(const Model& model, const Positions& x);

 private:
  TangentShares shares_;
  std::vector<std::size_t> first_number_;  // by sampled chunk
  AlignedVector<double> numbers_, now_;    // of the sampled chunks; of one of them
  double total_ = 0;                       // of the matrix' numbers over the sampled elements [N/m]
};

}  // namespace supple
