// Declares the loops of linear algebra, as a table of functions that is compiled once for each instruction set
// (base/variants.h). All take plain arrays. Not here: the uses of the loops (cholesky.h, solver/lbfgs.h).
#pragma once

#include <cstdint>

#include "sim/linear/front_layout.h"

namespace supple {

constexpr int panel_width = 8;
constexpr int columns_together = 16;  // right-hand sides of down_many_float
constexpr int product_tile = 4;       // vectors on either side of end_products

// Describes a Cholesky factor that is cut into panels of adjacent columns with one row pattern. It is row-major: each
// row of a panel holds its `width` values.
struct PanelsView {
  int panels;
  const std::int32_t* first_column;  // by panel
  const std::int32_t* width;         // by panel, 1 to panel_width
  const std::int64_t* first_row;     // by panel, into rows; panels + 1 entries
  const std::int32_t* rows;          // below the triangle
  const std::int64_t* first_value;  // by panel, into values: triangle (width x width, inverted diagonal), then the rows
  const void* values;               // float or double
};

struct LinearKernels {
  // Eliminates the pivots of a dense symmetric front that is stored as front_layout.h describes, with the padding and
  // everything above the diagonal set to 0. The columns become columns of L, and the update matrix becomes what
  // elimination leaves of the others; above the diagonal the result is undefined. The products are subtracted from each
  // number one by one in the order of the pivots. Returns the first pivot that is not positive, or -1.
  int (*eliminate)(FrontShape front, double* columns, double* update);

  // These functions solve the part of one front in L x = b, in place, and in L^T x = b. The triangle on the diagonal of
  // each strip is inverted (invert_triangles in changing_factor.h). `own`: x at the front's first
  // pivot; rows: the index in x of each row below the pivots. scratch: as many numbers as the front has padded rows,
  // aligned like the columns.
  template <class T>
  using FrontStep = void (*)(FrontShape front, const T* columns, const std::int32_t* rows, T* own, T* x, T* scratch);
  FrontStep<float> front_down_float, front_up_float;
  FrontStep<double> front_down_double, front_up_double;

  // Solves L x = b (down) or L^T x = b (up) in place for four interleaved right-hand sides (n x 4), by panels of up to
  // panel_width columns: those of an ascending list, or all of them (null). Numbers that belong to other panels are
  // read only by down, as targets, and are not used by up if the list contains all panels on which its own depend.
  void (*down_float)(const PanelsView& panels, const std::int32_t* list, int count, float* x);
  void (*up_float)(const PanelsView& panels, const std::int32_t* list, int count, float* x);
  void (*down_double)(const PanelsView& panels, const std::int32_t* list, int count, double* x);
  void (*up_double)(const PanelsView& panels, const std::int32_t* list, int count, double* x);

  // Does what down_float does for columns_together interleaved right-hand sides, on a list of panels. x is aligned to
  // cache lines.
  void (*down_many_float)(const PanelsView& panels, const std::int32_t* list, int count, float* x);
  void (*down_many_double)(const PanelsView& panels, const std::int32_t* list, int count, double* x);

  // products[i * product_tile + j] = a_i . b_j over the last count[i * product_tile + j] numbers of both. Vectors are
  // given by their ends, which are aligned to cache lines. A product does not depend on the others.
  void (*end_products)(const float* const* a_end, const float* const* b_end, const std::int32_t* count,
                       float* products);

  // dots[i] = a_i . b over [begin, end)
  void (*dots)(const double* const* a, int count, const double* b, long begin, long end, double* dots);
  // r += sum_i c_i a_i over [begin, end)
  void (*add_scaled)(const double* const* a, const double* c, int count, double* r, long begin, long end);
};

// Returns the loops of the widest variant that this machine can run, or of any variant that it can (base/variants.h).
const LinearKernels& linear_kernels();
const LinearKernels& linear_kernels(int variant);

}  // namespace supple
