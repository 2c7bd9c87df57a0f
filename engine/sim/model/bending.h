// Builds the energy by which cloth resists bending, E = 1/2 tr(x^T Q x) with a constant Q: B/2 times the squared mean
// curvature (the sum of both), which on a sheet that does not stretch is the Laplacian of the positions (Bergou,
// Wardetzky, Harmon, Zorin, Grinspun 2006, "A quadratic bending model for inextensible surfaces"). Q is part of A as a
// whole. Inside the sheet it is sum_v |L_v x|^2 / A_v, with the cotangent Laplacian L_v of each vertex and the area
// A_v that is nearest to it. A vertex on a border has no such Laplacian; for its share of the area, the hinges
// between triangles count. Elsewhere squares of single hinges, as in that paper, would make a sheet up to three times
// too stiff in some directions, and sheets that fold at every other vertex too soft. Cloth that is curved at rest must
// also know the direction of its curvature S, because the mean alone would let a rolled sheet roll up along the other
// axis. It has the energy of a plate of Poisson's ratio 0, B/2 |S - S_rest|^2 = B/4 (trace)^2 + B/2 |deviator|^2: half
// of the squares above and, for the deviator, the second derivatives of the quadratic function through the corners of a
// triangle and its neighbours' tips (Zorin 2005, "Curvature-based energy for simulation and variational modeling"). Not
// here: the evaluation beside elements (solver/objective.cpp), and the turning of curved squares (rest_curvature.h).
#pragma once

#include <vector>

#include "base/aligned.h"
#include "sim/model/model.h"

namespace supple {

// Lists the pairs of vertices that the triangles of a cloth and its bending join, each at least once, in the numbering
// of its mesh.
std::vector<JoinedVertices> joined_by_cloth(const BodyDescription& body);

// Returns Q over all vertices in the model's numbering, both triangles of it, for a bending stiffness of 1 N m [1/m^2].
Eigen::SparseMatrix<double> bending_matrix(const Model& model, const BodyDescription& body);

// Returns the energy of a curved cloth whose shape at rest is model.rest, for a bending stiffness of 1 N m, without
// what RestCurvature::index() makes.
RestCurvature rest_curvature(const Model& model, const BodyDescription& body);

// Computes row v of Q z, from differences, so that it does not depend on where the cloth is [N]. For many rows:
// LinearKernels::difference_rows.
inline void bending_row(const Model::SparseRows& bending, const double* z, int v, double (&row)[3]) {
  const double x = z[3 * std::size_t(v)], y = z[3 * std::size_t(v) + 1], up = z[3 * std::size_t(v) + 2];
  double sum[3] = {0, 0, 0};
  for (std::int32_t k = bending.begin[v]; k < bending.begin[v + 1]; ++k) {
    const double* other = z + 3 * std::size_t(bending.column[k]);
    const double value = bending.value[k];
    sum[0] += value * (other[0] - x);
    sum[1] += value * (other[1] - y);
    sum[2] += value * (other[2] - up);
  }
  for (int c = 0; c < 3; ++c) row[c] = sum[c];
}

// Holds what the multiplication of Q by places needs and finds, by vertex (LinearKernels::difference_rows).
struct BendingRoom {
  AlignedVector<double> places;  // n x 4 [m]
  AlignedVector<double> forces;  // n x 4 [N]
  std::vector<double> squares;   // n; minus four times a vertex's share of the energy [J]

  // Takes the places of all vertices, n x 3.
  void take(const double* x, int vertices);
};

// Returns the diagonal entry of row v of Q, which is minus the sum of the others [N/m].
inline double bending_diagonal(const Model::SparseRows& bending, int v) {
  double sum = 0;
  for (std::int32_t k = bending.begin[v]; k < bending.begin[v + 1]; ++k) sum -= bending.value[k];
  return sum;
}

// Returns the energy at x, n x 3 [J].
double bending_energy(const Model& model, const Positions& x);

}  // namespace supple
