// Holds a matrix that search directions start from, over the free vertices of a body, with its factor: A = M/h^2 + L of
// a model (model.h), or one that follows the body (tangent_system.h). It couples vertices, not coordinates: one n x n
// factor serves x, y and z.
#pragma once

#include <Eigen/SparseCore>

#include "sim/linear/cholesky.h"

namespace supple {

struct System {
  std::uint64_t id = 0;  // changes whenever the numbers do, so that what was derived from them can be renewed
  Eigen::SparseMatrix<double> matrix;  // lower triangle [N/m]
  std::vector<double> diagonal;        // by free vertex [N/m]
  struct Coupling {                    // an entry between a free vertex and one that a hard handle holds
    std::int32_t free;
    std::int32_t held;
    double value;
  };
  std::vector<Coupling> couplings;  // sorted by free vertex
  CholeskyFactor factor;
};

}  // namespace supple
