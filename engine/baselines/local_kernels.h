// Declares the loops over elements of the methods that solve many small problems, vertex block descent and ADMM, as a
// table of functions that is compiled once for each instruction set, like sim/elements/element_kernels.h.
#pragma once

#include "sim/elements/element_kernels.h"

namespace supple {

constexpr int corner_numbers = 9;     // dE/dx of a corner, then the packed block of second derivatives
constexpr int most_multipliers = 12;  // those of a tetrahedron: 9 of F, and 3 of F d for fibres; a spring has 3

struct LocalKernels {
  // Writes for each lane what moving the element's corner 1 changes: the force there [N] and the block [N/m],
  // corner_numbers in all (element_corner.h).
  void (*corners)(const ElementChunk& chunk, const double* x, double* out);

  // Makes ADMM's local step of each element (element_proximal.h), or with `start` sets its multipliers to the stress at
  // x. k: weight of its material in A [Pa]. multipliers: blocks x most_multipliers x block_width. Writes the forces on
  // the vertices of the chunk's list (vertices x 3) [N].
  void (*proximal)(const ElementChunk& chunk, double k, const double* x, bool start, double* multipliers,
                   double* force);
};

// Returns the loops of the widest variant that this machine can run, or of a given variant, which it must be able to
// run (base/variants.h).
const LocalKernels& local_kernels();
const LocalKernels& local_kernels(int variant);

}  // namespace supple
