// How search directions take contacts into account. Their stiffness is many times that of A = M/h^2 + L, which does not
// contain it and is never factored anew for it. With K = sum k n n^T over the stiff directions n (a touching vertex'
// normal; also its tangents while it sticks), two corrections need no factorisation of A + K:
//   diagonal  H = P A^-1 P + N diag(1 / (a + k)) N^T,  P = I - N N^T, a the diagonal of A: each stiff direction answers
//             for itself. This costs next to nothing.
//   low_rank  H = (A + K)^-1 = A^-1 - A^-1 N (K^-1 + N^T A^-1 N)^-1 N^T A^-1 (Woodbury). This costs one solve and parts
//             of it (linear/parted_solve.h), and a small dense system (capacitance.h). Where there are more stiff
//             directions than that may have, those of some vertices are in it and stand for their neighbours, too: K'.
//             The rest, R, are scaled each by itself: H = T (A + K')^-1 T, T = I - R diag(1 - sqrt(a / (a + k))) R^T.
// All are symmetric and positive definite.
#pragma once

#include <vector>

#include "sim/contact/capacitance.h"
#include "sim/contact/contact.h"
#include "sim/linear/parted_solve.h"
#include "sim/model/inputs.h"
#include "sim/model/system_solve.h"

namespace supple {

// Scratch of the corrections, empty until a contact is made.
struct ContactCorrection {
  const System* matrix = nullptr;              // A here: the matrix in force, of the step; null: the model's own
  std::vector<StiffDirection> wanted;          // those of the contacts in force: normals, then tangents
  std::size_t normals = 0;                     // how many of these are normals
  std::vector<StiffDirection> together, rest;  // how they are treated
  Capacitance system;
  PartedSolve solve;
  FactorPart part;                      // what the system's vertices have to do with in the factor
  Eigen::VectorXf answer;               // by direction of the system
  std::vector<double> along, products;  // of L-BFGS steps: by stiff direction and pair; by pair and pair
  Positions push, back;                 // n_free x 3 [N], [m]
  Positions unbent;                     // the direction before foresee_contacts [m]
};

// The most directions that feel each other which a body's system may have.
std::size_t most_coupled_directions(const Model& model);

// Lists the stiff directions at x of the contacts found there in correction.wanted.
void find_stiff_directions(const Model& model, const std::vector<Contact>& contacts, const Positions& x,
                           double stick_length, ContactCorrection& correction);

// Makes a step independent of those before.
void begin_corrections(const Model& model, ContactCorrection& correction);

// Computes z = H r for these directions. Overwrites r.
void apply_inverse(const Model& model, const ContactSettings& settings, ContactCorrection& correction,
                   SolveScratch& scratch, Positions& r, Positions& z);

// Bends a direction where it would lead from x through planes of `contacts` that are near and not yet touched: the
// quadratic model with their energies, which the full step would meet, is minimised anew; vertices that would still go
// through stop at their planes. Without this most full steps are rejected once a contact patch grows. Returns whether
// it was bent; it may then lead uphill, and the direction before is in correction.unbent.
bool foresee_contacts(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                      const Positions& x, ContactCorrection& correction, Positions& direction);

}  // namespace supple
