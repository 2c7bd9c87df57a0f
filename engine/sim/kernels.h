// The hot loops, as a table of functions compiled once for each instruction set that the build covers; kernels() picks
// the best one that the machine has. All take plain arrays. Not here: what the loops are for (objective.h, cholesky.h,
// lbfgs.h).
#pragma once

#include <cstdint>

#include "sim/elements/element.h"
#include "sim/material.h"

namespace supple {

// Elements are stored in blocks of this many, whatever the register width: field by field, one element a lane.
constexpr int block_width = 8;

// A run of blocks of one kind and material with its own short list of vertices: small enough that its positions and
// forces stay in the first-level cache, and the unit of work of a thread.
struct ElementChunk {
  ElementKind kind;
  const Material* material;  // of tetrahedra
  const Fibre* fibre;        // of tetrahedra; null: none
  int blocks;
  int vertices;                 // of the list
  const std::int32_t* vertex;   // the list: mesh vertices
  const std::uint16_t* corner;  // blocks x corners x block_width indices into the list
  const double* field;          // blocks x fields x block_width: what the kind needs to know of an element
};

struct Kernels {
  const char* name;

  // Energies by element [J] into energy (blocks x block_width); returns the sum of energy - previous (previous may be
  // null: 0). With force != null also the gradient by list vertex into force (vertices x 3) [N]. local: scratch of
  // vertices x 3.
  double (*elements)(const ElementChunk& chunk, const double* x, const double* previous, double* energy, double* force,
                     double* local);

  // Second derivatives of each element's energy, or the nearest positive semi-definite ones: by lane, the packed lower
  // triangle over the coordinates of all corners but the first (stiffness_numbers of them), whose rows follow from
  // translations. [N/m]
  void (*stiffness)(const ElementChunk& chunk, const double* x, bool project, double* out);

  // By lane: the largest stretch, and the volume over that at rest, negative where an element is inverted.
  void (*stretches)(const ElementChunk& chunk, const double* x, double* largest, double* volume);

  // Eliminates the first `pivots` columns of a dense symmetric front of `size` rows: its lower triangle, column-major,
  // a column of `stride` numbers (a multiple of 8 and no less than size; those below the front must be 0 and stay so).
  // They become columns of L, the others what elimination leaves of them (the update matrix). Above the diagonal
  // anything may stand afterwards. Returns the first pivot that is not positive, or -1.
  int (*eliminate)(double* front, long stride, int size, int pivots);

  // Solves L L^T x = b in place for four interleaved right-hand sides (n x 4), by panels of up to panel_width columns.
  void (*solve_float)(const struct PanelsView& panels, float* x);
  void (*solve_double)(const struct PanelsView& panels, double* x);

  // dots[i] = a_i . b over [begin, end)
  void (*dots)(const double* const* a, int count, const double* b, long begin, long end, double* dots);
  // r += sum_i c_i a_i over [begin, end)
  void (*add_scaled)(const double* const* a, const double* c, int count, double* r, long begin, long end);
};

constexpr int stiffness_numbers(ElementKind kind) { return kind == ElementKind::tetrahedron ? 45 : 6; }

constexpr int panel_width = 8;

// A Cholesky factor cut into panels of adjacent columns with one row pattern. Row-major: each row of a panel holds its
// `width` values.
struct PanelsView {
  int panels;
  const std::int32_t* first_column;  // by panel
  const std::int32_t* width;         // by panel, 1 to panel_width
  const std::int64_t* first_row;     // by panel, into rows; panels + 1 entries
  const std::int32_t* rows;          // below the triangle
  const std::int64_t* first_value;  // by panel, into values: triangle (width x width, inverted diagonal), then the rows
  const void* values;               // float or double
};

const Kernels& kernels();

// Every variant that this machine can run, for tests.
const Kernels* const* kernel_variants(int& count);

}  // namespace supple
