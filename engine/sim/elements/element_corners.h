// Moves numbers between the lists of a chunk's vertices (element_kernels.h) and registers that hold one element in each
// lane. A list has list_stride numbers for each vertex, which one register takes at once; the rows of several elements
// are then transposed. Like lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#include <cstdint>

#include "base/lanes.h"
#include "sim/elements/element_kernels.h"

namespace supple {
namespace {

// A block has these registers in single precision: one, or two where the machine's registers are narrow.
constexpr int single_lanes = 2 * lanes < block_width ? 2 * lanes : block_width;
using SingleLanes = xsimd::make_sized_batch_t<float, single_lanes>;

// Holds `count` numbers; arithmetic is by entry.
template <class T, int count>
struct WideOf {
  typedef T Type __attribute__((vector_size(count * sizeof(T))));
};
template <class T, int count>
using Wide = typename WideOf<T, count>::Type;
static_assert(list_stride == 4);
template <class T>
using Quad = Wide<T, 4>;

template <class R>
[[gnu::always_inline]] inline void load_row(const void* from, R& row) {
  __builtin_memcpy(&row, from, sizeof row);
}
template <class R>
[[gnu::always_inline]] inline void store_row(const R& row, void* to) {
  __builtin_memcpy(to, &row, sizeof row);
}

// Joins rows side by side. (A function that returned so wide a vector would be one that other files call with other
// registers in mind.)
template <class T>
[[gnu::always_inline]] inline void join(const Wide<T, 4>& a, const Wide<T, 4>& b, Wide<T, 8>& out) {
  out = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
template <class T>
[[gnu::always_inline]] inline void join(const Wide<T, 8>& a, const Wide<T, 8>& b, Wide<T, 16>& out) {
  out = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

// Transposes each four columns of four rows.
template <class T>
[[gnu::always_inline]] inline void transpose(Wide<T, 4> (&r)[4]) {
  const Wide<T, 4> low01 = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
                   high01 = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7),
                   low23 = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
                   high23 = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
  r[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
  r[2] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
  r[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
}
template <class T>
[[gnu::always_inline]] inline void transpose(Wide<T, 8> (&r)[4]) {
  const Wide<T, 8> low01 = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13),
                   high01 = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15),
                   low23 = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13),
                   high23 = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
  r[0] = __builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13);
  r[1] = __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15);
  r[2] = __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13);
  r[3] = __builtin_shufflevector(high01, high23, 2, 3, 10, 11, 6, 7, 14, 15);
}
template <class T>
[[gnu::always_inline]] inline void transpose(Wide<T, 16> (&r)[4]) {
  const Wide<T, 16> low01 =
                        __builtin_shufflevector(r[0], r[1], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29),
                    high01 =
                        __builtin_shufflevector(r[0], r[1], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31),
                    low23 =
                        __builtin_shufflevector(r[2], r[3], 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29),
                    high23 =
                        __builtin_shufflevector(r[2], r[3], 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
  r[0] = __builtin_shufflevector(low01, low23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
  r[1] = __builtin_shufflevector(low01, low23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
  r[2] = __builtin_shufflevector(high01, high23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
  r[3] = __builtin_shufflevector(high01, high23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
}

template <class V>
[[gnu::always_inline]] inline V batch_of(const Wide<typename V::value_type, V::size>& row) {
  using Register = typename V::register_type;
  return V(reinterpret_cast<const Register&>(row));
}
template <class V>
[[gnu::always_inline]] inline Wide<typename V::value_type, V::size> row_of(const V& batch) {
  const typename V::register_type value = batch;
  return reinterpret_cast<const Wide<typename V::value_type, V::size>&>(value);
}

// Turns one row for each lane into three registers, one for each coordinate.
template <class V>
[[gnu::always_inline]] inline void from_rows(const Quad<typename V::value_type> (&row)[V::size], V (&out)[3]) {
  using T = typename V::value_type;
  if constexpr (V::size == 2) {
    out[0] = batch_of<V>(__builtin_shufflevector(row[0], row[1], 0, 4));
    out[1] = batch_of<V>(__builtin_shufflevector(row[0], row[1], 1, 5));
    out[2] = batch_of<V>(__builtin_shufflevector(row[0], row[1], 2, 6));
  } else {
    Wide<T, V::size> r[4];
    for (int i = 0; i < 4; ++i) {
      // Elements i, i + 4, ... come into one register, in which each four columns are transposed.
      if constexpr (V::size == 16) {
        Wide<T, 8> low, high;
        join<T>(row[i], row[i + 4], low);
        join<T>(row[i + 8], row[i + 12], high);
        join<T>(low, high, r[i]);
      } else if constexpr (V::size == 8) {
        join<T>(row[i], row[i + 4], r[i]);
      } else {
        r[i] = row[i];
      }
    }
    transpose<T>(r);
    for (int c = 0; c < 3; ++c) out[c] = batch_of<V>(r[c]);
  }
}

// Does the opposite; the fourth number of each row is 0.
template <class V>
[[gnu::always_inline]] inline void to_rows(const V (&in)[3], Quad<typename V::value_type> (&row)[V::size]) {
  using T = typename V::value_type;
  const Wide<T, V::size> zero{};
  if constexpr (V::size == 2) {
    const Quad<T> xy = __builtin_shufflevector(row_of(in[0]), row_of(in[1]), 0, 2, 1, 3),
                  z = __builtin_shufflevector(row_of(in[2]), zero, 0, 2, 1, 3);
    row[0] = __builtin_shufflevector(xy, z, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(xy, z, 2, 3, 6, 7);
  } else {
    Wide<T, V::size> r[4] = {row_of(in[0]), row_of(in[1]), row_of(in[2]), zero};
    transpose<T>(r);
    for (int i = 0; i < 4; ++i) {
      if constexpr (V::size == 16) {
        row[i] = __builtin_shufflevector(r[i], r[i], 0, 1, 2, 3);
        row[i + 4] = __builtin_shufflevector(r[i], r[i], 4, 5, 6, 7);
        row[i + 8] = __builtin_shufflevector(r[i], r[i], 8, 9, 10, 11);
        row[i + 12] = __builtin_shufflevector(r[i], r[i], 12, 13, 14, 15);
      } else if constexpr (V::size == 8) {
        row[i] = __builtin_shufflevector(r[i], r[i], 0, 1, 2, 3);
        row[i + 4] = __builtin_shufflevector(r[i], r[i], 4, 5, 6, 7);
      } else {
        row[i] = r[i];
      }
    }
  }
}

// Takes the positions of the elements' corners from a list. corner: of the first lane, block_width apart for each
// corner. In single precision they are positions relative to the first corner, which is subtracted in double precision.
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

// Adds the forces on all corners but the first to a list, and takes their sum from the first corner's. Elements are
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
