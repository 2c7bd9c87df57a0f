// Solves with A = M/h^2 + L, for the free vertices of a body.
#pragma once

#include "base/aligned.h"
#include "sim/model/model.h"

namespace supple {

// Room for the solves of one thread.
using SolveScratch = AlignedVector<double>;

// z = A^-1 r, both n_free x 3 [m], [N]. Where nothing holds the body, its centre of mass moves as it does exactly, even
// though the factor has single precision.
void solve_system(const Model& model, const Positions& r, Positions& z, SolveScratch& scratch);

}  // namespace supple
