// Solves with A = M/h^2 + L, or with another matrix of that kind, for the free vertices of a body.
#pragma once

#include "base/aligned.h"
#include "sim/model/model.h"

namespace supple {

// Provides memory for the solves of one thread.
using SolveScratch = AlignedVector<double>;

// Computes z = A^-1 r, both n_free x 3 [m], [N]. Where nothing holds the body, its centre of mass moves as in the exact
// solution, even though the factor has single precision.
void solve_system(const Model& model, const Positions& r, Positions& z, SolveScratch& scratch);
// Does the same with the matrix of `system`. Like A, it must resist translations by the body's inertia alone.
void solve_system(const Model& model, const System& system, const Positions& r, Positions& z, SolveScratch& scratch);

// Adds to z = A^-1 r what single precision misses, for all parts that nothing holds. Such a part moves as a whole by
// exactly 1^T M z = h^2/w 1^T r, because L does not see translations; a solve in single precision moves it only nearly
// so, and would let the centre of mass drift.
void restore_translation(const Model& model, const Positions& r, Positions& z);

}  // namespace supple
