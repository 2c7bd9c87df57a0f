// Transposes rows of four numbers (x, y, z and an unused one) of several vertices into registers that hold one vertex
// in each lane, and back. Like lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#include "base/lanes.h"

namespace supple {
namespace {

// Holds `count` numbers; arithmetic is by entry.
template <class T, int count>
struct WideOf {
  typedef T Type __attribute__((vector_size(count * sizeof(T))));
};
template <class T, int count>
using Wide = typename WideOf<T, count>::Type;
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

// Joins two rows side by side in `out`. (They are not returned, because the registers in which a function returns so
// wide a vector depend on the instruction set of the file.)
template <class T>
[[gnu::always_inline]] inline void join(const Wide<T, 4>& a, const Wide<T, 4>& b, Wide<T, 8>& out) {
  out = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
template <class T>
[[gnu::always_inline]] inline void join(const Wide<T, 8>& a, const Wide<T, 8>& b, Wide<T, 16>& out) {
  out = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

// Takes four rows as blocks of 4 x 4 numbers side by side, and transposes each block in its place.
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
      // r[i] gets rows i, i + 4, ... side by side: each becomes row i of a 4 x 4 block that transpose() turns.
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

// Does the opposite of from_rows(); the fourth number of each row is 0.
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

}  // namespace
}  // namespace supple
