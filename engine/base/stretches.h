// Takes small matrices apart into rotations and stretches. Not here: the same in SIMD lanes, for elements
// (sim/elements/svd.h, sim/elements/polar_rotation.h).
#pragma once

#include <array>

#include "base/types.h"

namespace supple {

// Holds the singular value decomposition F = U diag(stretch) V^T of a 3 x 3 matrix, with a sign that makes U V^T a
// rotation always; U and V themselves may both mirror. The stretches are in descending order of size. Where the matrix
// mirrors, the last one is below 0 (Irving, Teran, Fedkiw 2004, "Invertible finite elements for robust simulation of
// large deformation"). All numbers are NaN where F is not finite.
struct SignedSvd {
  Mat3 u, v;
  Vec3 stretch;

  explicit SignedSvd(const Mat3& f);

  Mat3 rotation() const;  // U V^T
};

// Returns the rotation R that is nearest to a matrix, which is the one that maximises tr(R^T F). Where det F > 0 it is
// the rotation of the polar decomposition. For F = sum m_i y_i x_i^T, with points x_i and y_i relative to their means
// weighted by m_i, R x_i is nearest to y_i in the least squares (Kabsch 1976, "A solution for the best rotation to
// relate two sets of vectors"). Several rotations are equally near where the last two stretches sum to 0, as for points
// in a line; one of them is returned.
Mat3 nearest_rotation(const Mat3& f);

// Returns the two stretches of a flat piece in its plane, the larger one first; NaN where a number is not finite.
// squares: 2 x 2, F^T F of its 3 x 2 deformation gradient, or a matrix with the same eigenvalues.
std::array<double, 2> flat_stretches(const Eigen::Matrix2d& squares);

}  // namespace supple
