#include "base/stretches.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SignedSvd::SignedSvd(const Mat3& f) {
  if (!f.allFinite()) {  // Eigen leaves its results unset then
    u.setConstant(unknown);
    v.setConstant(unknown);
    stretch.setConstant(unknown);
    return;
  }
  const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  u = svd.matrixU();
  v = svd.matrixV();
  stretch = svd.singularValues();
  if ((u * v.transpose()).determinant() < 0) {
    u.col(2) *= -1;
    stretch[2] *= -1;
  }
}

Mat3 SignedSvd::rotation() const { return u * v.transpose(); }

Mat3 nearest_rotation(const Mat3& f) { return SignedSvd(f).rotation(); }

std::array<double, 2> flat_stretches(const Eigen::Matrix2d& squares) {
  if (!squares.allFinite()) return {unknown, unknown};
  const double mean = 0.5 * (squares(0, 0) + squares(1, 1)), half = 0.5 * (squares(0, 0) - squares(1, 1));
  const double apart = std::sqrt(std::max(0.0, half * half + squares(0, 1) * squares(1, 0)));
  return {std::sqrt(std::max(0.0, mean + apart)), std::sqrt(std::max(0.0, mean - apart))};
}

}  // namespace supple
