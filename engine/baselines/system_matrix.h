// Builds A = M/h^2 + L as a matrix, for methods that solve it in another way than by the model's factor.
#pragma once

#include <Eigen/SparseCore>

#include "sim/model/model.h"

namespace supple {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Returns A over the free vertices, both triangles [N/m].
SparseMatrix system_matrix_of(const Model& model);

}  // namespace supple
