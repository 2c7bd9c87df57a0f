// Provides sparse matrices with known properties, for tests of factors, as lower triangles, and dense copies of them.
#pragma once

#include <Eigen/SparseCore>

#include "sim/model/model.h"

namespace supple::test {

using Sparse = Eigen::SparseMatrix<double>;

// Makes a random matrix with about `links` entries a column, which its diagonal makes positive definite.
Sparse random_matrix(int size, double links, unsigned seed);

// Makes the 7-point Laplacian of a grid plus a little mass, either in an order with little fill or in the grid's own
// order.
Sparse grid_matrix(int n, bool ordered, double mass);

// Makes a matrix of 3 x 3 blocks on a grid in an order with little fill, with whole blocks on the diagonal, as
// HessianMatrix stores them; `shift` is added to the diagonal of a positive semi-definite sum.
Sparse block_matrix(int n, double shift, unsigned seed);

// Returns the whole symmetric matrix.
Eigen::MatrixXd dense(const Sparse& matrix);

// Returns A over all coordinates of the free vertices, 3 n_free x 3 n_free.
Eigen::MatrixXd dense_system(const Model& model);

}  // namespace supple::test
