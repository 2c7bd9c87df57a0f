// What search directions make of contacts. Their stiffness is many times that of A = M/h^2 + L, which does not hold it
// and is never factored anew for it. Two corrections need no factorisation of A + K, K = sum k n n^T over the stiff
// directions n (a touching vertex' normal; also its tangents while it sticks):
//   diagonal  H = P A^-1 P + N diag(1 / (a + k)) N^T,  P = I - N N^T, a the diagonal of A: each stiff direction answers
//             for itself. Costs next to nothing.
//   low_rank  H = (A + K)^-1 = A^-1 - A^-1 N (K^-1 + N^T A^-1 N)^-1 N^T A^-1 (Woodbury): one more solve, a dense
//             factorisation as large as there are stiff directions, and the columns of A^-1 of touched vertices, which
//             are found once for each (x, y and z share them) and kept while there is room.
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
  std::vector<StiffDirection> wanted;    // of the contacts in force: normals, then tangents
  std::size_t normals = 0;               // how many of these are normals
  std::vector<StiffDirection> chosen;    // of these
  std::vector<StiffDirection> stiff;     // that the factor was made for
  std::vector<std::int32_t> column_of;   // by vertex: place in `inverse`; -1: not touched yet
  std::vector<Eigen::VectorXf> inverse;  // columns of A^-1 of touched vertices [m/N]
  Eigen::MatrixXf lower;                 // Cholesky factor of the capacitance K^-1 + N^T A^-1 N
  Eigen::VectorXf answer;
  std::vector<double> along, products;  // of L-BFGS steps: by stiff direction and pair; by pair and pair
  std::vector<float> entered;           // depth by stiff direction that a direction would make [m]
  Positions push, back;                 // n_free x 3
  Positions unbent;                     // the direction before foresee_contacts [m]
};

// The stiff directions of the contacts in force at workspace.x, into workspace.correction.wanted.
void stiff_directions(const Model& model, Workspace& workspace);

// Makes a step independent of those before: the factor is forgotten, and columns of A^-1 when they are too many.
void forget_factor(const Model& model, ContactCorrection& correction);

// z = H r for these. Overwrites r.
void apply_inverse(const Model& model, Workspace& workspace, const ContactSettings& settings, Positions& r,
                   Positions& z);

// Bends workspace.direction where it would lead through planes that are near and not yet touched: the quadratic model
// with their energies, which the full step would meet, is minimised anew. Without this most full steps are rejected
// once a contact patch grows. Returns whether it was bent; it may then lead uphill.
bool foresee_contacts(const Model& model, const ContactSettings& settings, Workspace& workspace);

}  // namespace supple
