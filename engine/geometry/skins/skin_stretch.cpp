#include "geometry/skins/skin_stretch.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace supple {

double mean_edge(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e)
    sum += (mesh.rest.row(mesh.tets(e, 1)) - mesh.rest.row(mesh.tets(e, 0))).norm();
  return sum / static_cast<double>(std::max<Eigen::Index>(1, mesh.tets.rows()));
}

StretchedEdge most_stretched_edge(const TriMesh& rest, const Positions& now, double shortest) {
  StretchedEdge most;
  double square = most.factor * most.factor;
  for (Eigen::Index t = 0; t < rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = rest.triangles(t, k), to = rest.triangles(t, (k + 1) % 3);
      const double before = (rest.points.row(from) - rest.points.row(to)).squaredNorm();
      const double after = (now.row(from) - now.row(to)).squaredNorm();
      if (!(after > square * before) || !(before > 0) || before < shortest * shortest) continue;
      square = after / before;
      most = {from, to, std::sqrt(square)};
    }
  }
  return most;
}

double largest_element_stretch(const TetMesh& mesh, const Positions& now) {
  double square = 0;
  const auto edges = [&mesh](const Positions& at, Eigen::Index e) {
    Mat3 result;
    for (int k = 0; k < 3; ++k) result.col(k) = (at.row(mesh.tets(e, k + 1)) - at.row(mesh.tets(e, 0))).transpose();
    return result;
  };
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const Mat3 gradient = edges(now, e) * edges(mesh.rest, e).inverse();
    const Mat3 product = gradient.transpose() * gradient;
    if (product.squaredNorm() <= square * square) continue;  // no eigenvalue is above this norm
    const Eigen::SelfAdjointEigenSolver<Mat3> squares(product, Eigen::EigenvaluesOnly);
    square = std::max(square, squares.eigenvalues().maxCoeff());
  }
  return std::sqrt(square);
}

}  // namespace supple
