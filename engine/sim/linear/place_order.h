// Orders the unknowns of a sparse matrix for elimination by where they lie: nested dissection whose cuts are planes. It
// takes a small part of the time of an order by the pattern alone (fill_reducing_order(), cholesky.h) and serves
// matrices whose pattern changes from step to step; fill is larger.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "base/types.h"

namespace supple {

// Returns an order of elimination: order[k] is the k-th unknown to be eliminated. pattern: a matrix of which either
// triangle, or both, are stored; places: by unknown [m].
std::vector<std::int32_t> place_order(const Eigen::SparseMatrix<double>& pattern, const Positions& places);

}  // namespace supple
