// How search directions take contacts into account. Their stiffness is many times that of A = M/h^2 + L, which does not
// contain it and is never factored anew for it. Two corrections need no factorisation of A + K, K = sum k n n^T over
// the stiff directions n (a touching vertex' normal; also its tangents while it sticks):
//   diagonal  H = P A^-1 P + N diag(1 / (a + k)) N^T,  P = I - N N^T, a the diagonal of A: each stiff direction answers
//             for itself. This costs next to nothing.
//   low_rank  H = (A + K)^-1 = A^-1 - A^-1 N (K^-1 + N^T A^-1 N)^-1 N^T A^-1 (Woodbury). This costs one more
//             solve, a dense factorisation of as many rows as there are stiff directions, and the columns of A^-1 of
//             touched vertices, which are found once for each (x, y and z share them) and kept while there is room.
// Both are symmetric and positive definite.
#pragma once

#include <vector>

#include "sim/contact/contact.h"
#include "sim/model/inputs.h"
#include "sim/model/system_solve.h"

namespace supple {

struct StiffDirection {
  std::int32_t vertex;
  Vec3 axis;         // of unit length
  double stiffness;  // k [N/m]
};

// Scratch of the corrections, empty until a contact is made.
struct ContactCorrection {
  std::vector<StiffDirection> wanted;    // those of the contacts in force: normals, then tangents
  std::size_t normals = 0;               // how many of these are normals
  std::vector<StiffDirection> chosen;    // those of them that are corrected for
  std::vector<StiffDirection> stiff;     // those that the factor was made for
  std::vector<std::int32_t> column_of;   // by vertex: place in `inverse`; -1: not touched yet
  std::vector<Eigen::VectorXf> inverse;  // columns of A^-1 of touched vertices [m/N]
  Eigen::MatrixXf lower;                 // Cholesky factor of the capacitance K^-1 + N^T A^-1 N
  Eigen::VectorXf answer;
  std::vector<double> along, products;  // of L-BFGS steps: by stiff direction and pair; by pair and pair
  std::vector<float> entered;           // depth by stiff direction that a direction would make [m]
  Positions push, back;                 // n_free x 3
  Positions unbent;                     // the direction before foresee_contacts [m]
};

// Lists the stiff directions at x of the contacts found there in correction.wanted.
void find_stiff_directions(const Model& model, const std::vector<Contact>& contacts, const Positions& x,
                           double stick_length, ContactCorrection& correction);

// Makes a step independent of those before: forgets the factor, and the columns of A^-1 when there are too many.
void forget_factor(const Model& model, ContactCorrection& correction);

// Computes z = H r for these directions. Overwrites r.
void apply_inverse(const Model& model, const ContactSettings& settings, ContactCorrection& correction,
                   SolveScratch& scratch, Positions& r, Positions& z);

// Bends a direction where it would lead from x through planes of `contacts` that are near and not yet touched: the
// quadratic model with their energies, which the full step would meet, is minimised anew. Without this most full steps
// are rejected once a contact patch grows. Returns whether it was bent; it may then lead uphill, and the direction
// before is in correction.unbent.
bool foresee_contacts(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                      const Positions& x, ContactCorrection& correction, SolveScratch& scratch, Positions& direction);

}  // namespace supple
