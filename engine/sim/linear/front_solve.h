// Solves with the columns of fronts (front_layout.h) for one right-hand side, in single or double precision. The
// triangles on the diagonals of strips are inverted beforehand (multifrontal.h), so that no unknown waits for
// another one. Like lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include <type_traits>

#include "base/lanes.h"
#include "sim/linear/front_layout.h"

namespace supple {
namespace {

// These registers have lanes that divide a block of rows.
constexpr int float_lanes = 2 * lanes < block_rows ? 2 * lanes : block_rows;
template <class T>
using Row = std::conditional_t<std::is_same_v<T, float>, xsimd::make_sized_batch_t<float, float_lanes>, Lanes>;
template <class T>
constexpr int row_lanes = std::is_same_v<T, float> ? float_lanes : lanes;

// Computes x = T^-1 x with the inverse of the triangle T by columns. `own` gets x, padded with zeros.
template <class T, int width>
void solve_triangle(const T* inverse, T* x, T (&own)[block_rows]) {
  for (int i = 0; i < block_rows; i += row_lanes<T>) {
    Row<T> sum(T(0));
    for (int j = 0; j < width; ++j) sum = fma(Row<T>(x[j]), Row<T>::load_aligned(inverse + j * block_rows + i), sum);
    sum.store_aligned(own + i);
  }
  for (int j = 0; j < width; ++j) x[j] = own[j];
}

// Computes x = T^-T (x - taken).
template <class T, int width>
void solve_triangle_up(const T* inverse, const T (&taken)[block_rows], T* x) {
  T left[width];
  for (int j = 0; j < width; ++j) left[j] = x[j] - taken[j];
  for (int j = 0; j < width; ++j) {
    T sum = 0;
    for (int i = j; i < width; ++i) sum += inverse[j * block_rows + i] * left[i];
    x[j] = sum;
  }
}

template <class T>
T sum_of(const Row<T>& row) {
  alignas(64) T part[row_lanes<T>];
  row.store_aligned(part);
  T sum = part[0];
  for (int i = 1; i < row_lanes<T>; ++i) sum += part[i];
  return sum;
}

// Solves with the triangle of a strip, and subtracts the strip times its part of x from the rows below the triangle.
template <class T, int width>
void strip_down(const T* inverse, int blocks, T* x) {
  alignas(64) T own[block_rows];
  solve_triangle<T, width>(inverse, x, own);
  const T* numbers = inverse + block_rows * width;
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
void strip_up(const T* inverse, int blocks, T* x) {
  const T* numbers = inverse + block_rows * width;
  Row<T> sum[width];
  for (int j = 0; j < width; ++j) sum[j] = Row<T>(T(0));
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width) {
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      const Row<T> known = Row<T>::load_aligned(x + b * block_rows + i);
      for (int j = 0; j < width; ++j) sum[j] = fma(known, Row<T>::load_aligned(numbers + j * block_rows + i), sum[j]);
    }
  }
  T taken[block_rows];
  for (int j = 0; j < width; ++j) taken[j] = sum_of<T>(sum[j]);
  solve_triangle_up<T, width>(inverse, taken, x);
}

#if defined(__AVX512F__) && defined(__AVX512DQ__)
// In single precision a register of 512 bits holds two columns of a block.
inline __m256 lower_half(__m512 v) { return _mm512_castps512_ps256(v); }
inline __m256 upper_half(__m512 v) { return _mm512_extractf32x8_ps(v, 1); }

template <int width>
requires(width > 1) void strip_down_in_pairs(const float* inverse, int blocks, float* x) {
  constexpr int pairs = width / 2;
  alignas(64) float own[block_rows];
  solve_triangle<float, width>(inverse, x, own);
  __m512 known[pairs];
  for (int j = 0; j < pairs; ++j)
    known[j] = _mm512_insertf32x8(_mm512_set1_ps(own[2 * j]), _mm256_set1_ps(own[2 * j + 1]), 1);
  const __m256 last = _mm256_set1_ps(own[width - 1]);
  const float* numbers = inverse + block_rows * width;
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width) {
    __m512 both = _mm512_mul_ps(known[0], _mm512_loadu_ps(numbers));
    for (int j = 1; j < pairs; ++j)
      both = _mm512_fmadd_ps(known[j], _mm512_loadu_ps(numbers + 2 * j * block_rows), both);
    __m256 sum = _mm256_sub_ps(_mm256_load_ps(x + b * block_rows), _mm256_add_ps(lower_half(both), upper_half(both)));
    if constexpr (width % 2 != 0)
      sum = _mm256_fnmadd_ps(last, _mm256_loadu_ps(numbers + (width - 1) * block_rows), sum);
    _mm256_store_ps(x + b * block_rows, sum);
  }
}

template <int width>
requires(width > 1) void strip_up_in_pairs(const float* inverse, int blocks, float* x) {
  constexpr int pairs = width / 2;
  __m512 sum[pairs];
  for (int j = 0; j < pairs; ++j) sum[j] = _mm512_setzero_ps();
  __m256 last = _mm256_setzero_ps();
  const float* numbers = inverse + block_rows * width;
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width) {
    const __m256 known = _mm256_load_ps(x + b * block_rows);
    const __m512 twice = _mm512_broadcast_f32x8(known);
    for (int j = 0; j < pairs; ++j)
      sum[j] = _mm512_fmadd_ps(twice, _mm512_loadu_ps(numbers + 2 * j * block_rows), sum[j]);
    if constexpr (width % 2 != 0)
      last = _mm256_fmadd_ps(known, _mm256_loadu_ps(numbers + (width - 1) * block_rows), last);
  }
  float taken[block_rows];
  for (int j = 0; j < pairs; ++j) {
    taken[2 * j] = sum_of<float>(lower_half(sum[j]));
    taken[2 * j + 1] = sum_of<float>(upper_half(sum[j]));
  }
  if constexpr (width % 2 != 0) taken[width - 1] = sum_of<float>(last);
  solve_triangle_up<float, width>(inverse, taken, x);
}
#endif

template <class T, int width>
constexpr auto down_step() {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (std::is_same_v<T, float> && width > 1) return strip_down_in_pairs<width>;
#endif
  return strip_down<T, width>;
}

template <class T, int width>
constexpr auto up_step() {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (std::is_same_v<T, float> && width > 1) return strip_up_in_pairs<width>;
#endif
  return strip_up<T, width>;
}

template <class T>
using StripStep = void (*)(const T*, int, T*);

template <class T>
void solve_down(FrontShape front, const T* columns, const std::int32_t* rows, T* own, T* x, T* scratch) {
  static constexpr StripStep<T> step[block_rows] = {down_step<T, 1>(), down_step<T, 2>(), down_step<T, 3>(),
                                                    down_step<T, 4>(), down_step<T, 5>(), down_step<T, 6>(),
                                                    down_step<T, 7>(), down_step<T, 8>()};
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
  static constexpr StripStep<T> step[block_rows] = {up_step<T, 1>(), up_step<T, 2>(), up_step<T, 3>(), up_step<T, 4>(),
                                                    up_step<T, 5>(), up_step<T, 6>(), up_step<T, 7>(), up_step<T, 8>()};
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
