// Moves numbers between the lists of a chunk's vertices (element_kernels.h) and registers that hold one element in each
// lane. A list has list_stride numbers for each vertex, which one register takes at once; the rows of several elements
// are then transposed. Like lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#include <cstdint>

#include "base/lane_rows.h"
#include "base/lanes.h"
#include "sim/elements/element_kernels.h"

namespace supple {
namespace {

// A block fills one to four of these registers in single precision, by how wide the machine's registers are.
constexpr int single_lanes = 2 * lanes < block_width ? 2 * lanes : block_width;
using SingleLanes = xsimd::make_sized_batch_t<float, single_lanes>;
static_assert(list_stride == 4);

// Takes the positions of the elements' corners from a list. corner: the indices into the list, from the first lane's
// for corner 0 on; those for the next corner are block_width further. In single precision the positions are relative to
// the first corner, which is subtracted in double precision.
template <class V, int corners>
[[gnu::always_inline]] inline void load_corners(const double* list, const std::uint16_t* corner, V (&x)[corners][3]) {
  using T = typename V::value_type;
  Quad<double> first[V::size];
  for (std::size_t i = 0; i < V::size; ++i) load_row(list + list_stride * std::size_t(corner[i]), first[i]);
#pragma GCC unroll 4
  for (int k = 0; k < corners; ++k) {
    if constexpr (is_single<V>) {
      if (k == 0) {
        for (V& zero : x[0]) zero = V(0.0F);
        continue;
      }
    }
    Quad<T> row[V::size];
    for (std::size_t i = 0; i < V::size; ++i) {
      Quad<double> at;
      load_row(list + list_stride * std::size_t(corner[k * block_width + int(i)]), at);
      if constexpr (is_single<V>) {
        row[i] = __builtin_convertvector(at - first[i], Quad<float>);
      } else {
        row[i] = at;
      }
    }
    from_rows<V>(row, x[k]);
  }
}

// Adds the forces on all corners but the first to a list, and subtracts their sum at the first corner. Elements are
// added in their order, so that the sums do not depend on the width of the registers.
template <class V, int corners>
[[gnu::always_inline]] inline void add_forces(const V (&force)[corners - 1][3], const std::uint16_t* corner,
                                              double* list) {
  Quad<typename V::value_type> row[corners - 1][V::size];
  for (int k = 0; k < corners - 1; ++k) to_rows<V>(force[k], row[k]);
  for (std::size_t i = 0; i < V::size; ++i) {
    Quad<double> sum{};
    for (int k = 0; k < corners - 1; ++k) {
      const auto added = __builtin_convertvector(row[k][i], Quad<double>);
      double* to = list + list_stride * std::size_t(corner[(k + 1) * block_width + int(i)]);
      Quad<double> now;
      load_row(to, now);
      store_row(now + added, to);
      sum += added;
    }
    double* to = list + list_stride * std::size_t(corner[i]);
    Quad<double> now;
    load_row(to, now);
    store_row(now - sum, to);
  }
}

}  // namespace
}  // namespace supple
