// Computes columns of L^-1 many at a time, and products of such columns, for entries of the inverse
// (inverse_entries.h). Every number depends on its own columns alone, in one order of sums, not on the columns that are
// processed together with it. Like lanes.h it is only for files that are compiled once for each instruction set.
#pragma once

#include "base/lanes.h"
#include "sim/linear/linear_kernels.h"

namespace supple {
namespace {

// Solves L x = b with one strip for columns_together right-hand sides, as many at a time as a register holds.
template <class T, int width>
void forward_many(const FactorView& view, int strip, T* x) {
  using Part = xsimd::batch<T>;
  const FactorFront& front = view.fronts[view.front_of[strip]];
  const int place = strip - front.first_strip;  // among the front's strips
  const T* inverse = static_cast<const T*>(view.numbers) + front.first_number + strip_begin(front.shape, place);
  const std::int32_t* rows = view.rows + front.first_row;
  for (int slice = 0; slice < columns_together; slice += static_cast<int>(Part::size)) {
    const auto at = [&](std::int64_t unknown) { return x + columns_together * unknown + slice; };
    const std::int64_t own = front.first + place * block_rows;
    Part known[width];
    for (int j = width - 1; j >= 0; --j) {
      known[j] = Part(T(0));
      for (int k = 0; k <= j; ++k)
        known[j] = fma(Part(inverse[k * block_rows + j]), Part::load_aligned(at(own + k)), known[j]);
      known[j].store_aligned(at(own + j));
    }
    const auto take = [&](const T* numbers, int i, std::int64_t unknown) {
      Part sum = Part::load_aligned(at(unknown));
      for (int j = 0; j < width; ++j) sum = fnma(Part(numbers[j * block_rows + i]), known[j], sum);
      sum.store_aligned(at(unknown));
    };
    const T* numbers = inverse + block_rows * width;
    for (int i = block_rows; i < front.shape.pivots - place * block_rows; ++i)
      take(numbers + (i / block_rows - 1) * block_rows * width, i % block_rows, own + i);
    numbers += (strips_of(front.shape) - place - 1) * block_rows * width;
    for (int i = 0; i < front.shape.rows; ++i)
      take(numbers + i / block_rows * block_rows * width, i % block_rows, rows[i]);
  }
}

template <class T>
void down_many(const FactorView& view, const std::int32_t* list, int count, T* x) {
  using Step = void (*)(const FactorView&, int, T*);
  static constexpr Step step[block_rows] = {forward_many<T, 1>, forward_many<T, 2>, forward_many<T, 3>,
                                            forward_many<T, 4>, forward_many<T, 5>, forward_many<T, 6>,
                                            forward_many<T, 7>, forward_many<T, 8>};
  for (int i = 0; i < count; ++i) {
    const FactorFront& front = view.fronts[view.front_of[list[i]]];
    step[strip_width(front.shape, list[i] - front.first_strip) - 1](view, list[i], x);
  }
}

using Floats = xsimd::batch<float>;
constexpr long floats = static_cast<long>(Floats::size);

// Multiplies the last `count` numbers of two vectors, a register at a time from their ends on, and adds the sums of the
// lanes in order.
struct EndProduct {
  Floats sum = Floats(0.0f);
  long done = 0;

  void go_on(const float* a_end, const float* b_end, long count) {
    for (; done + floats <= count; done += floats)
      sum = fma(Floats::load_aligned(a_end - done - floats), Floats::load_aligned(b_end - done - floats), sum);
  }
  float finish(const float* a_end, const float* b_end, long count) {
    go_on(a_end, b_end, count);
    alignas(64) float part[floats];
    sum.store_aligned(part);
    for (long i = 0; i < count - done; ++i) part[i] += a_end[i - count] * b_end[i - count];
    float all = part[0];
    for (long i = 1; i < floats; ++i) all += part[i];
    return all;
  }
};

void end_products(const float* const* a_end, const float* const* b_end, const std::int32_t* count, float* products) {
  long common = count[0];
  for (int i = 1; i < product_tile * product_tile; ++i) common = std::min<long>(common, count[i]);
  EndProduct pair[product_tile][product_tile];
  const long together = common / floats * floats;
  for (long done = 0; done < together; done += floats) {
    Floats b[product_tile];
    for (int j = 0; j < product_tile; ++j) b[j] = Floats::load_aligned(b_end[j] - done - floats);
    for (int i = 0; i < product_tile; ++i) {
      const Floats a = Floats::load_aligned(a_end[i] - done - floats);
      for (int j = 0; j < product_tile; ++j) pair[i][j].sum = fma(a, b[j], pair[i][j].sum);
    }
  }
  for (int i = 0; i < product_tile; ++i) {
    for (int j = 0; j < product_tile; ++j) {
      pair[i][j].done = together;
      products[i * product_tile + j] = pair[i][j].finish(a_end[i], b_end[j], count[i * product_tile + j]);
    }
  }
}

}  // namespace
}  // namespace supple
