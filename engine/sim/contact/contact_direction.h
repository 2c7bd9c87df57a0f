// Corrects search directions for contacts. The stiffness of contacts is many times that of A = M/h^2 + L; A does not
// contain it and is never factored again for it. With K = sum k n n^T over the stiff directions n (a touching point's
// normal; also its tangents while it sticks), two corrections need no factorisation of A + K:
//   diagonal  H = P A^-1 P + N diag(1 / (a + k)) N^T,  P = I - N N^T, a the diagonal of A: each stiff direction is
//             treated by itself. This costs almost nothing.
//   low_rank  H = (A + K)^-1 = A^-1 - A^-1 N (K^-1 + N^T A^-1 N)^-1 N^T A^-1 (Woodbury). This costs one solve and parts
//             of it (linear/parted_solve.h), and a small system (capacitance.h). When there are more stiff directions
//             than that system may have, it contains those of some vertices, which also represent their neighbours: K'.
//             Each of the others, R, is scaled by itself: H = T (A + K')^-1 T,
//             T = I - R diag(1 - sqrt(a / (a + k))) R^T.
// The second of these uses A^-1 + Z D Z^T in place of A^-1 for directions that have a second level
// (coarse/second_level.h). Of cloth that lies, many more contacts stick than the system may have. What sticks is then
// in the matrix itself (sticking_system.h), for the rest of the step and without a second level: H = T (A + sum k w
// w^T)^-1 T, with R the directions of all other contacts and a the diagonal of this matrix. All of these H are
// symmetric and positive definite.
#pragma once

#include <vector>

#include "sim/coarse/second_level.h"
#include "sim/contact/capacitance.h"
#include "sim/contact/contact.h"
#include "sim/contact/sticking_system.h"
#include "sim/linear/parted_solve.h"
#include "sim/model/inputs.h"
#include "sim/model/system_solve.h"

namespace supple {

// Holds the scratch memory of the corrections; it is empty until a contact occurs.
struct ContactCorrection {
  const System* matrix = nullptr;                // called A here: the step's matrix in force; null: the model's A
  Threads* threads = nullptr;                    // null: the calling thread works alone
  std::vector<StiffDirection> wanted;            // stiff directions of the contacts in force: normals, then tangents
  std::size_t normals = 0;                       // how many of them are normals
  std::vector<StiffDirection> together, rest;    // those that `system` couples, and those scaled by themselves
  bool may_stick = false;                        // the step begins with cloth that lies, and nothing else
  std::vector<StickingSystem::Spring> sticking;  // for each contact that sticks, where they may
  std::vector<StiffDirection> loose;             // the wanted directions of all other contacts there
  StickingSystem stuck;                          // takes the place of `system` where most contacts stick
  Capacitance system;
  PartedSolve solve;
  FactorPart part;                      // the part of the factor that the system's vertices involve
  Eigen::VectorXf answer;               // by direction of the system
  std::vector<double> along, products;  // for L-BFGS steps s: n . s, and s_i . K s_j
  Positions push, back;                 // n_free x 3 [N], [m]
  Positions unbent;                     // the direction before foresee_contacts [m]
  // The second level of directions (coarse/second_level.h); null: there is none.
  SecondLevel* second = nullptr;
  Eigen::VectorXd coarse;  // Z^T of the forces, r numbers
  AddedMotions motions;    // those of the second level, for the system
};

// Returns the largest number of mutually coupled directions that the system of a body alone may have. For several
// bodies, the operations that factor the system are limited instead.
std::size_t most_coupled_directions(const Model& model);

// Lists in correction.wanted the stiff directions of the contacts found at x.
void find_stiff_directions(const Model& model, const std::vector<Contact>& contacts, const Positions& x,
                           ContactCorrection& correction);

// Makes a step independent of earlier ones.
void begin_corrections(const Model& model, ContactCorrection& correction);

// Says at which velocities a step begins (n x 3) [m/s]: contacts may stick where all parts are cloth that hardly moves.
void begin_sticking(const Model& model, const Positions& v, ContactCorrection& correction);

// Lets the matrix with what sticks serve the rest of the step where contacts may stick, the small system has no room
// for all that were found at x, and most of them do stick. To be called after find_stiff_directions().
void choose_sticking_system(const Model& model, const ContactSettings& settings, const Positions& x,
                            ContactCorrection& correction);

// Computes z = (A + K)^-1 r, with K of all directions in correction.wanted, where the matrix with what sticks serves: it
// is too stiff along planes, and tells too little of a slow slide. By conjugate gradients, preconditioned by H, until
// r^T H r of what is left is a ten-thousandth of that of r. Returns false where they do not come so far.
bool solve_with_all_contacts(const Model& model, ContactCorrection& correction, const Positions& r, Positions& z);

// Computes z = H r, with H for the directions in correction.wanted. Overwrites r.
void apply_inverse(const Model& model, const ContactSettings& settings, ContactCorrection& correction,
                   SolveScratch& scratch, Positions& r, Positions& z);

// Bends a direction that would lead from x through planes of `contacts` that are near and not yet touched. The
// quadratic model is minimised again with the energies of these planes, which the full step would meet; where the
// system would have too many directions, the points stop at these planes instead. Without this, most full steps are
// rejected once a contact patch grows. Returns whether the direction was bent. A bent direction may lead uphill; the
// one before is kept in correction.unbent.
bool foresee_contacts(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                      const Positions& x, ContactCorrection& correction, Positions& direction);

// Corrects the arc of a search (coarse/turning.h) that is to be added to this direction, so that it leads the body
// along the planes as the direction does. Takes out of the arc what departs from the planes that the direction takes
// into account, and what would go through other planes.
void keep_bow_on_planes(const Model& model, const ContactSettings& settings, const std::vector<Contact>& contacts,
                        const Positions& x, const Positions& direction, ContactCorrection& correction, Positions& bow);

}  // namespace supple
