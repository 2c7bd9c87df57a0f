// Solves with the columns of fronts (front_layout.h) for three right-hand sides at once, in single or double precision.
// The unknowns are rows of four numbers, of which the last one is unused. Those of a front are transposed into blocks
// of block_rows rows by coordinate, so that one register of L serves three products; fronts of one strip, whose
// products are too few for that, are solved with rows as they are. Like lanes.h it is only for files that are compiled
// once for each instruction set.
#pragma once

#if defined(__FMA__) || defined(__AVX__)
#include <immintrin.h>
#endif

#include "base/lane_rows.h"
#include "base/lanes.h"
#include "sim/linear/front_solve.h"
#include "sim/linear/linear_kernels.h"

namespace supple {
namespace {

constexpr int block_numbers = 3 * block_rows;  // of a block of unknowns: x, y and z of each row

// Columns whose sums fit into registers together with the rows they are multiplied with.
constexpr int columns_at_once = lanes == 8 ? 8 : 4;

template <class T>
constexpr int row_parts = block_rows / row_lanes<T>;

// Holds one row of unknowns.
template <class T>
struct Four {
  Quad<T> v;

  static Four load(const T* p) {
    Four f;
    load_row(p, f.v);
    return f;
  }
  void store(T* p) const { store_row(v, p); }
  // Subtracts a times x from this.
  void subtract_scaled(T a, const Four& x) {
#if defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      v = _mm_fnmadd_ps(_mm_set1_ps(a), x.v, v);
    } else {
      v = _mm256_fnmadd_pd(_mm256_set1_pd(a), x.v, v);
    }
#else
    v -= a * x.v;
#endif
  }
};

// Describes one front of a factor and where its unknowns are.
template <class T>
struct FrontSolve {
  FrontShape shape;
  const T* columns;
  const std::int32_t* rows;  // of the unknowns below the pivots
  T* own;                    // the row of the first pivot
  T* x;                      // the row of unknown 0
  T* scratch;                // blocks of unknowns

  FrontSolve(const FactorView& view, int front, T* unknowns, T* room)
      : shape(view.fronts[front].shape),
        columns(static_cast<const T*>(view.numbers) + view.fronts[front].first_number),
        rows(view.rows + view.fronts[front].first_row),
        own(unknowns + 4 * std::int64_t(view.fronts[front].first)),
        x(unknowns),
        scratch(room) {}

  // Returns the row of an unknown by its place among those below the pivots.
  T* row_below(int place) const { return x + 4 * std::int64_t(rows[place]); }
};

// Calls work(row, block, count) for blocks of up to block_rows rows.
template <class Work>
void for_blocks(int rows, const Work& work) {
  for (int row = 0, block = 0; row < rows; row += block_rows, ++block)
    work(row, block, rows - row < block_rows ? rows - row : block_rows);
}

// Transposes up to block_rows rows into a block, which is padded with zeros. row(i): the address of row i.
template <class T, class RowOf>
void rows_to_block(const RowOf& row, int count, T* block) {
  for (int part = 0; part < row_parts<T>; ++part) {
    const int first = part * row_lanes<T>;
    Quad<T> of[row_lanes<T>] = {};
    if (count >= first + row_lanes<T>) {
      for (int i = 0; i < row_lanes<T>; ++i) load_row(row(first + i), of[i]);
    } else {
      for (int i = 0; first + i < count; ++i) load_row(row(first + i), of[i]);
    }
    Row<T> coordinate[3];
    from_rows<Row<T>>(of, coordinate);
    for (int c = 0; c < 3; ++c) coordinate[c].store_aligned(block + c * block_rows + first);
  }
}

// Does the opposite: calls put(i, row) for the rows of a block.
template <class T, class Put>
void block_to_rows(const T* block, int count, const Put& put) {
  for (int part = 0; part < row_parts<T>; ++part) {
    const int first = part * row_lanes<T>;
    Row<T> coordinate[3];
    for (int c = 0; c < 3; ++c) coordinate[c] = Row<T>::load_aligned(block + c * block_rows + first);
    Quad<T> row[row_lanes<T>];
    to_rows<Row<T>>(coordinate, row);
    if (count >= first + row_lanes<T>) {
      for (int i = 0; i < row_lanes<T>; ++i) put(first + i, row[i]);
    } else {
      for (int i = 0; first + i < count; ++i) put(first + i, row[i]);
    }
  }
}

// Subtracts `together` blocks of a strip times `known` from the unknowns below its triangle.
template <class T, int width, int together>
void take_blocks(const T* numbers, const Row<T> (&known)[3][width], T* x) {
  for (int i = 0; i < block_rows; i += row_lanes<T>) {
    Row<T> sum[together][3];
    for (int b = 0; b < together; ++b) {
      for (int c = 0; c < 3; ++c) sum[b][c] = Row<T>::load_aligned(x + b * block_numbers + c * block_rows + i);
    }
    for (int j = 0; j < width; ++j) {
      for (int b = 0; b < together; ++b) {
        const Row<T> l = Row<T>::load_aligned(numbers + (b * width + j) * block_rows + i);
        for (int c = 0; c < 3; ++c) sum[b][c] = fnma(known[c][j], l, sum[b][c]);
      }
    }
    for (int b = 0; b < together; ++b) {
      for (int c = 0; c < 3; ++c) sum[b][c].store_aligned(x + b * block_numbers + c * block_rows + i);
    }
  }
}

// Solves with the triangle of a strip, and subtracts the strip times its unknowns from those below.
template <class T, int width>
void three_down(const T* inverse, int blocks, T* x) {
  alignas(64) T own[block_numbers];
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      Row<T> sum(T(0));
      for (int j = 0; j < width; ++j)
        sum = fma(Row<T>(x[c * block_rows + j]), Row<T>::load_aligned(inverse + j * block_rows + i), sum);
      sum.store_aligned(own + c * block_rows + i);
    }
  }
  Row<T> known[3][width];
  for (int c = 0; c < 3; ++c) {
    for (int j = 0; j < width; ++j) known[c][j] = Row<T>(own[c * block_rows + j]);
  }
  for (int i = 0; i < block_numbers; ++i) x[i] = own[i];
  const T* numbers = inverse + block_rows * width;
  int b = 1;
  for (; b + 2 <= blocks; b += 2, numbers += 2 * block_rows * width)
    take_blocks<T, width, 2>(numbers, known, x + b * block_numbers);
  if (b < blocks) take_blocks<T, width, 1>(numbers, known, x + b * block_numbers);
}

// Sums the lanes of each of `width` registers.
template <class T, int width>
void sums_of(const Row<T> (&rows)[width], T* sums) {
  for (int first = 0; first < width; first += row_lanes<T>) {
    Row<T> group[row_lanes<T>];
    for (int i = 0; i < row_lanes<T>; ++i) group[i] = first + i < width ? rows[first + i] : Row<T>(T(0));
    xsimd::haddp(group).store_unaligned(sums + first);
  }
}

// Computes sums[c][j], the product of column j of a strip with coordinate c of the unknowns below the strip, for
// `count` of its `width` columns, `from` first.
template <class T, int width, int from, int count>
void sum_columns(const T* numbers, int blocks, const T* x, T (&sums)[3][block_rows]) {
  Row<T> sum[3][count];
  for (int c = 0; c < 3; ++c) {
    for (int j = 0; j < count; ++j) sum[c][j] = Row<T>(T(0));
  }
  for (int b = 1; b < blocks; ++b, numbers += block_rows * width, x += block_numbers) {
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      Row<T> known[3];
      for (int c = 0; c < 3; ++c) known[c] = Row<T>::load_aligned(x + c * block_rows + i);
      for (int j = 0; j < count; ++j) {
        const Row<T> l = Row<T>::load_aligned(numbers + (from + j) * block_rows + i);
        for (int c = 0; c < 3; ++c) sum[c][j] = fma(known[c], l, sum[c][j]);
      }
    }
  }
  for (int c = 0; c < 3; ++c) {
    alignas(64) T found[block_rows];
    sums_of<T, count>(sum[c], found);
    for (int j = 0; j < count; ++j) sums[c][from + j] = found[j];
  }
}

// Subtracts the strip's columns times the unknowns below it from the strip's own unknowns, and solves with its
// transposed triangle.
template <class T, int width>
void three_up(const T* inverse, int blocks, T* x) {
  const T* numbers = inverse + block_rows * width;
  alignas(64) T taken[3][block_rows] = {};
  if constexpr (width <= columns_at_once) {
    sum_columns<T, width, 0, width>(numbers, blocks, x + block_numbers, taken);
  } else {
    sum_columns<T, width, 0, columns_at_once>(numbers, blocks, x + block_numbers, taken);
    sum_columns<T, width, columns_at_once, width - columns_at_once>(numbers, blocks, x + block_numbers, taken);
  }
  for (int c = 0; c < 3; ++c) {
    Row<T> product[width];
    for (int j = 0; j < width; ++j) product[j] = Row<T>(T(0));
    for (int i = 0; i < block_rows; i += row_lanes<T>) {
      const Row<T> left = Row<T>::load_aligned(x + c * block_rows + i) - Row<T>::load_aligned(taken[c] + i);
      for (int j = 0; j < width; ++j)
        product[j] = fma(left, Row<T>::load_aligned(inverse + j * block_rows + i), product[j]);
    }
    alignas(64) T found[block_rows] = {};
    sums_of<T, width>(product, found);
    for (int j = 0; j < width; ++j) x[c * block_rows + j] = found[j];
  }
}

template <class T>
void wide_down(const FrontSolve<T>& f, int first_strip) {
  static constexpr StripStep<T> step[block_rows] = {three_down<T, 1>, three_down<T, 2>, three_down<T, 3>,
                                                    three_down<T, 4>, three_down<T, 5>, three_down<T, 6>,
                                                    three_down<T, 7>, three_down<T, 8>};
  const int strips = strips_of(f.shape), blocks = row_blocks_of(f.shape), first = first_strip * block_rows;
  T* const own = f.own + 4 * first;
  T* const own_blocks = f.scratch + first_strip * block_numbers;
  T* const below = f.scratch + strips * block_numbers;
  for_blocks(f.shape.pivots - first, [&](int row, int block, int count) {
    rows_to_block([&](int i) { return own + 4 * (row + i); }, count, own_blocks + block * block_numbers);
  });
  for (int i = 0; i < (blocks - strips) * block_numbers; ++i) below[i] = T(0);
  for (int strip = first_strip; strip < strips; ++strip)
    step[strip_width(f.shape, strip) - 1](f.columns + strip_begin(f.shape, strip), blocks - strip,
                                          f.scratch + strip * block_numbers);
  for_blocks(f.shape.pivots - first, [&](int row, int block, int count) {
    block_to_rows(own_blocks + block * block_numbers, count,
                  [&](int i, const Quad<T>& v) { store_row(v, own + 4 * (row + i)); });
  });
  for_blocks(f.shape.rows, [&](int row, int block, int count) {
    block_to_rows(below + block * block_numbers, count, [&](int i, const Quad<T>& v) {
      Quad<T> now;
      load_row(f.row_below(row + i), now);
      store_row(now + v, f.row_below(row + i));
    });
  });
}

template <class T>
void wide_up(const FrontSolve<T>& f, int first_strip) {
  static constexpr StripStep<T> step[block_rows] = {three_up<T, 1>, three_up<T, 2>, three_up<T, 3>, three_up<T, 4>,
                                                    three_up<T, 5>, three_up<T, 6>, three_up<T, 7>, three_up<T, 8>};
  const int strips = strips_of(f.shape), blocks = row_blocks_of(f.shape), first = first_strip * block_rows;
  T* const own = f.own + 4 * first;
  T* const own_blocks = f.scratch + first_strip * block_numbers;
  for_blocks(f.shape.pivots - first, [&](int row, int block, int count) {
    rows_to_block([&](int i) { return own + 4 * (row + i); }, count, own_blocks + block * block_numbers);
  });
  for_blocks(f.shape.rows, [&](int row, int block, int count) {
    rows_to_block([&](int i) { return f.row_below(row + i); }, count, f.scratch + (strips + block) * block_numbers);
  });
  for (int strip = strips - 1; strip >= first_strip; --strip)
    step[strip_width(f.shape, strip) - 1](f.columns + strip_begin(f.shape, strip), blocks - strip,
                                          f.scratch + strip * block_numbers);
  for_blocks(f.shape.pivots - first, [&](int row, int block, int count) {
    block_to_rows(own_blocks + block * block_numbers, count,
                  [&](int i, const Quad<T>& v) { store_row(v, own + 4 * (row + i)); });
  });
}

template <class T, int width>
void narrow_down(const FrontSolve<T>& f) {
  Four<T> known[width];
  for (int j = width - 1; j >= 0; --j) {
    known[j].v = Quad<T>{};
    for (int k = 0; k <= j; ++k) known[j].subtract_scaled(-f.columns[k * block_rows + j], Four<T>::load(f.own + 4 * k));
    known[j].store(f.own + 4 * j);
  }
  const T* numbers = f.columns + block_rows * width;
  for_blocks(f.shape.rows, [&](int row, int block, int count) {
    const T* l = numbers + block * block_rows * width;
    for (int i = 0; i < count; ++i) {
      Four<T> sum = Four<T>::load(f.row_below(row + i));
      for (int j = 0; j < width; ++j) sum.subtract_scaled(l[j * block_rows + i], known[j]);
      sum.store(f.row_below(row + i));
    }
  });
}

template <class T, int width>
void narrow_up(const FrontSolve<T>& f) {
  Four<T> sum[width];
  for (int j = 0; j < width; ++j) sum[j] = Four<T>::load(f.own + 4 * j);
  const T* numbers = f.columns + block_rows * width;
  for_blocks(f.shape.rows, [&](int row, int block, int count) {
    const T* l = numbers + block * block_rows * width;
    for (int i = 0; i < count; ++i) {
      const Four<T> known = Four<T>::load(f.row_below(row + i));
      for (int j = 0; j < width; ++j) sum[j].subtract_scaled(l[j * block_rows + i], known);
    }
  });
  for (int j = 0; j < width; ++j) {
    Four<T> x;
    x.v = Quad<T>{};
    for (int i = j; i < width; ++i) x.subtract_scaled(-f.columns[j * block_rows + i], sum[i]);
    x.store(f.own + 4 * j);
  }
}

// Calls work(front, first strip) for the fronts of an ascending list of strips, or for all of them (null).
template <bool backwards, class Work>
void for_fronts(const FactorView& view, const std::int32_t* list, int count, const Work& work) {
  if (list == nullptr) {
    for (int i = 0; i < view.front_count; ++i) work(backwards ? view.front_count - 1 - i : i, 0);
    return;
  }
  // The strips of a front are neighbours in the list.
  for (int i = 0; i < count;) {
    const int at = backwards ? count - 1 - i : i, front = view.front_of[list[at]];
    int same = 1;
    while (i + same < count && view.front_of[list[backwards ? at - same : at + same]] == front) ++same;
    work(front, list[backwards ? at - same + 1 : at] - view.fronts[front].first_strip);
    i += same;
  }
}

template <class T>
void down(const FactorView& view, const std::int32_t* list, int count, T* x, T* scratch) {
  using NarrowStep = void (*)(const FrontSolve<T>&);
  static constexpr NarrowStep narrow[block_rows] = {narrow_down<T, 1>, narrow_down<T, 2>, narrow_down<T, 3>,
                                                    narrow_down<T, 4>, narrow_down<T, 5>, narrow_down<T, 6>,
                                                    narrow_down<T, 7>, narrow_down<T, 8>};
  for_fronts<false>(view, list, count, [&](int front, int first_strip) {
    const FrontSolve<T> f(view, front, x, scratch);
    f.shape.pivots <= block_rows ? narrow[f.shape.pivots - 1](f) : wide_down(f, first_strip);
  });
}

template <class T>
void up(const FactorView& view, const std::int32_t* list, int count, T* x, T* scratch) {
  using NarrowStep = void (*)(const FrontSolve<T>&);
  static constexpr NarrowStep narrow[block_rows] = {narrow_up<T, 1>, narrow_up<T, 2>, narrow_up<T, 3>, narrow_up<T, 4>,
                                                    narrow_up<T, 5>, narrow_up<T, 6>, narrow_up<T, 7>, narrow_up<T, 8>};
  for_fronts<true>(view, list, count, [&](int front, int first_strip) {
    const FrontSolve<T> f(view, front, x, scratch);
    f.shape.pivots <= block_rows ? narrow[f.shape.pivots - 1](f) : wide_up(f, first_strip);
  });
}

}  // namespace
}  // namespace supple
