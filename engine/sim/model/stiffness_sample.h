// Tells how far the elements' stiffness has departed since a matrix was made of it, and so when to make a new matrix.
#pragma once

#include "base/aligned.h"
#include "sim/model/model.h"

namespace supple {

// Holds the shares of S and A in the matrix. S is the stiffness at one pose, but a step covers an interval. The
// stiffness of A is fitted over an interval, so A keeps directions short where a material has next to no stiffness in
// the present pose but stiffens on its way.
struct TangentShares {
  double tangent = 0.9;
  double constant = 0.1;
  double axial = 0.7;  // along each principal axis, S is at least this share of the stiffness along it alone
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

  // Returns the sum of the changes of the elements' stiffness since take(), over the sum of their stiffness in the
  // matrix; 0 where elements have only turned.
  double departure(const Model& model, const Positions& x);

 private:
  TangentShares shares_;
  std::vector<std::size_t> first_number_;  // by sampled chunk
  AlignedVector<double> numbers_, now_;    // stiffness of all sampled chunks when taken; of one chunk now
  double total_ = 0;                       // of the matrix' numbers over the sampled elements [N/m]
};

}  // namespace supple
