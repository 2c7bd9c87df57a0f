// Provides sparse matrices with known properties, for tests of factors. They are stored as lower triangles.
#pragma once

#include <Eigen/SparseCore>

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

}  // namespace supple::test
