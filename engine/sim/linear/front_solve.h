// Solves with the columns of fronts (front_layout.h) for one right-hand side, in single or double precision. Like
// lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#include <type_traits>

#include "base/lanes.h"
#include "sim/linear/front_layout.h"

namespace supple {
namespace {

// Registers whose lanes divide a block of rows.
constexpr int float_lanes = 2 * lanes < block_rows ? 2 * lanes : block_rows;
template <class T>
using Row = std::conditional_t<std::is_same_v<T, float>, xsimd::make_sized_batch_t<float, float_lanes>, Lanes>;
template <class T>
constexpr int row_lanes = std::is_same_v<T, float> ? float_lanes : lanes;

// Subtracts a strip times its part of x from the rows below its triangle.
template <class T, int width>
void strip_down(const T* triangle, int blocks, T* x) {
  T own[width];
  for (int j = 0; j < width; ++j) {
    own[j] = x[j];
    for (int k = 0; k < j; ++k) own[j] -= triangle[k * block_rows + j] * own[k];
    x[j] = own[j] /= triangle[j * block_rows + j];
  }
  const T* numbers = triangle + block_rows * width;
  Row<T> known[width];
  for (int j = 0; j < width; ++j) known[j] = Row<T>(own[j]);
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width) {
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      Row<T> sum = Row<T>::load_aligned(x + b * block_rows + i);
      for (int j = 0; j < width; ++j) sum = fnma(known[j], Row<T>::load_aligned(numbers + j * block_rows + i), sum);
      sum.store_aligned(x + b * block_rows + i);
    }
  }
}

template <class T, int width>
void strip_up(const T* triangle, int blocks, T* x) {
  const T* numbers = triangle + block_rows * width;
  Row<T> sum[width];
  for (int j = 0; j < width; ++j) sum[j] = Row<T>(T(0));
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width) {
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      const Row<T> known = Row<T>::load_aligned(x + b * block_rows + i);
      for (int j = 0; j < width; ++j) sum[j] = fma(known, Row<T>::load_aligned(numbers + j * block_rows + i), sum[j]);
    }
  }
  for (int j = width - 1; j >= 0; --j) {
    alignas(64) T part[row_lanes<T>];
    sum[j].store_aligned(part);
    T all = part[0];
    for (int i = 1; i < row_lanes<T>; ++i) all += part[i];
    T own = x[j] - all;
    for (int k = j + 1; k < width; ++k) own -= triangle[j * block_rows + k] * x[k];
    x[j] = own / triangle[j * block_rows + j];
  }
}

template <class T>
using StripStep = void (*)(const T*, int, T*);

template <class T>
void solve_down(FrontShape front, const T* columns, const std::int32_t* rows, T* own, T* x, T* scratch) {
  static constexpr StripStep<T> step[block_rows] = {strip_down<T, 1>, strip_down<T, 2>, strip_down<T, 3>,
                                                    strip_down<T, 4>, strip_down<T, 5>, strip_down<T, 6>,
                                                    strip_down<T, 7>, strip_down<T, 8>};
  const int strips = strips_of(front), blocks = row_blocks_of(front);
  for (int i = 0; i < blocks * block_rows; ++i) scratch[i] = i < front.pivots ? own[i] : T(0);
  for (int strip = 0; strip < strips; ++strip)
    step[strip_width(front, strip) - 1](columns + strip_begin(front, strip), blocks - strip,
                                        scratch + strip * block_rows);
  for (int i = 0; i < front.pivots; ++i) own[i] = scratch[i];
  const T* taken = scratch + strips * block_rows;
  for (int i = 0; i < front.rows; ++i) x[rows[i]] += taken[i];
}

template <class T>
void solve_up(FrontShape front, const T* columns, const std::int32_t* rows, T* own, T* x, T* scratch) {
  static constexpr StripStep<T> step[block_rows] = {strip_up<T, 1>, strip_up<T, 2>, strip_up<T, 3>, strip_up<T, 4>,
                                                    strip_up<T, 5>, strip_up<T, 6>, strip_up<T, 7>, strip_up<T, 8>};
  const int strips = strips_of(front), blocks = row_blocks_of(front);
  for (int i = 0; i < strips * block_rows; ++i) scratch[i] = i < front.pivots ? own[i] : T(0);
  T* known = scratch + strips * block_rows;
  for (int i = 0; i < (blocks - strips) * block_rows; ++i) known[i] = i < front.rows ? x[rows[i]] : T(0);
  for (int strip = strips - 1; strip >= 0; --strip)
    step[strip_width(front, strip) - 1](columns + strip_begin(front, strip), blocks - strip,
                                        scratch + strip * block_rows);
  for (int i = 0; i < front.pivots; ++i) own[i] = scratch[i];
}

}  // namespace
}  // namespace supple
