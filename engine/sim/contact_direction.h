// What search directions make of contacts. Their stiffness is many times that of A = M/h^2 + L, which does not hold it
// and is never factored anew for it. Two corrections need no factorisation of A + K, K = sum k n n^T over the stiff
// directions n (a touching vertex' normal; also its tangents while it sticks):
//   diagonal  H = P A^-1 P + N diag(1 / (a + k)) N^T,  P = I - N N^T, a the diagonal of A: each stiff direction answers
//             for itself. Costs next to nothing.
//   low_rank  H = (A + K)^-1 = A^-1 - A^-1 N (K^-1 + N^T A^-1 N)^-1 N^T A^-1 (Woodbury): one more solve, a dense
//             factorisation as large as there are stiff directions, and entries of A^-1 between touched vertices, which
//             are found once for each vertex (x, y and z share them) and kept as long as the model lives.
// Both are symmetric and positive definite.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "base/types.h"

namespace supple {

struct Model;
struct Workspace;
struct ContactSettings;

struct StiffDirection {
  std::int32_t vertex;
  Vec3 axis;         // of unit length
  double stiffness;  // k [N/m]
};

// Scratch of the corrections, empty until a contact is made.
struct ContactCorrection {
  std::vector<StiffDirection> stiff;        // in force
  std::vector<StiffDirection> factored;     // that `capacitance` was made for
  std::vector<std::int32_t> column_of;      // by vertex: place among the touched ones; -1: never touched
  std::vector<std::int32_t> touched;        // vertices
  std::vector<std::vector<float>> inverse;  // A^-1 between touched vertices, by row up to the diagonal [m/N]
  Eigen::LLT<Eigen::MatrixXf> capacitance;  // of K^-1 + N^T A^-1 N
  Eigen::MatrixXf dense;
  Eigen::VectorXf answer;
};

// z = H r for the contacts in force. Overwrites r.
void apply_inverse(const Model& model, Workspace& workspace, const ContactSettings& settings, Positions& r,
                   Positions& z);

}  // namespace supple
