// Declares the loops of linear algebra, as a table of functions that is compiled once for each instruction set
// (base/variants.h). All take plain arrays. Not here: the uses of the loops (cholesky.h, solver/lbfgs.h).
#pragma once

#include <cstdint>

#include "sim/linear/front_layout.h"

namespace supple {

constexpr int columns_together = 16;  // right-hand sides of down_many
constexpr int product_tile = 4;       // vectors on either side of end_products

// Describes where the columns and unknowns of one front of a Cholesky factor are.
struct FactorFront {
  FrontShape shape;
  std::int32_t first;         // unknown of the first pivot
  std::int32_t first_strip;   // the front's strips have successive numbers
  std::int64_t first_row;     // into FactorView::rows: the unknowns below the pivots
  std::int64_t first_number;  // into FactorView::numbers
};

// Describes a Cholesky factor: the columns of its fronts (front_layout.h), with the triangle on the diagonal of each
// strip inverted (invert_triangles in multifrontal.h).
struct FactorView {
  int front_count, strip_count;
  const FactorFront* fronts;     // in the order of their pivots
  const std::int32_t* front_of;  // by strip
  const std::int32_t* rows;
  const void* numbers;  // float or double
};

// Holds a sparse matrix by rows, without its diagonal.
struct DifferenceRows {
  const std::int32_t* first;  // where each row's entries begin, and where the last row's end
  const std::int32_t* column;
  const double* value;
};

struct LinearKernels {
  // Eliminates the pivots of a dense symmetric front that is stored as front_layout.h describes, with the padding and
  // everything above the diagonal set to 0. The columns become columns of L, and the update matrix becomes what
  // elimination leaves of the others; above the diagonal the result is undefined. The products are subtracted from each
  // number one by one in the order of the pivots. Returns the first pivot that is not positive, or -1.
  int (*eliminate)(FrontShape front, double* columns, double* update);

  // These functions solve the part of one front in L x = b (down) or in L^T x = b (up), in place, for one right-hand
  // side. invert_triangles() (multifrontal.h) must have inverted the triangle on the diagonal of each strip. own: x at
  // the front's first pivot. rows: the index in x of each row below the pivots. scratch: as many numbers as the front
  // has padded rows, aligned like the columns.
  template <class T>
  using FrontStep = void (*)(FrontShape front, const T* columns, const std::int32_t* rows, T* own, T* x, T* scratch);
  FrontStep<float> front_down_float, front_up_float;
  FrontStep<double> front_down_double, front_up_double;

  // These functions solve L x = b (down) or L^T x = b (up) in place for three right-hand sides. x: n x 4, of which the
  // last column is unused. They use the strips of an ascending list, which contains all later strips of each of its
  // fronts, or all strips (null). Of numbers that belong to other strips, down changes only those in rows below the
  // strips of the list, and up uses none if the list contains all strips on which its own depend. scratch: three times
  // the padded rows of the largest front, aligned to cache lines.
  template <class T>
  using Solve = void (*)(const FactorView& factor, const std::int32_t* list, int count, T* x, T* scratch);
  Solve<float> down_float, up_float;
  Solve<double> down_double, up_double;

  // Does what down does for columns_together interleaved right-hand sides, on a list of strips. x is aligned to cache
  // lines.
  void (*down_many_float)(const FactorView& factor, const std::int32_t* list, int count, float* x);
  void (*down_many_double)(const FactorView& factor, const std::int32_t* list, int count, double* x);

  // Computes products[i * product_tile + j] = a_i . b_j over the last count[i * product_tile + j] numbers of both.
  // Vectors are given by their ends, which are aligned to cache lines. A product does not depend on the others.
  void (*end_products)(const float* const* a_end, const float* const* b_end, const std::int32_t* count,
                       float* products);

  // Computes dots[i] = a_i . b over [begin, end).
  void (*dots)(const double* const* a, int count, const double* b, long begin, long end, double* dots);
  // Adds sum_i c_i a_i to r over [begin, end).
  void (*add_scaled)(const double* const* a, const double* c, int count, double* r, long begin, long end);

  // Multiplies n x 3 numbers by a sparse matrix whose rows add up to zero and are given without the diagonal, from
  // differences: products[4 i] gets the sum of value (z_column - z_i), for the rows from `begin` to `end`. z and
  // products: n x 4, of which the last column is unused. squares (null: not wanted) gets by row the sum of value
  // |z_column - z_i|^2.
  void (*difference_rows)(const DifferenceRows& matrix, const double* z, int begin, int end, double* products,
                          double* squares);
};

// Returns the loops of the widest variant that this machine can run, or those of a given variant, which must be one
// that it can run (base/variants.h).
const LinearKernels& linear_kernels();
const LinearKernels& linear_kernels(int variant);

}  // namespace supple
