// This file is compiled once for each instruction set; SUPPLE_VARIANT names it.
#include "sim/linear/linear_kernels.h"

#include <utility>

#include "base/lane_rows.h"
#include "base/lanes.h"
#include "base/variants.h"
#include "sim/linear/column_kernels.h"
#include "sim/linear/front_solve.h"
#include "sim/linear/three_solve.h"

namespace supple {
namespace {

// Elimination works on tiles of row blocks by columns, whose numbers stay in registers while the earlier columns are
// applied.
constexpr int block_registers = block_rows / lanes;
constexpr int tile_blocks = lanes == 8 ? 3 : 1;
constexpr int tile_columns = lanes == 8 ? 8 : lanes == 4 ? 4 : 2;

// The columns of this many strips are subtracted from all later ones together: their part of a large front fits into
// the cache.
constexpr int strips_together = 16;

struct Tile {
  double* numbers;  // of the first row block and column
  long block_stride, column_stride;
};

// Subtracts the strips from first_strip to end_strip from a tile: row blocks from `row_block` down, and columns whose
// own rows are in block `column_block` from `offset` on.
template <int blocks, int width>
void take_strips(FrontShape front, const double* columns, int first_strip, int end_strip, int row_block,
                 int column_block, int offset, const Tile& tile) {
  constexpr int registers = blocks * block_registers;
  Lanes sum[width][registers];
  double* to[blocks];
  for (int b = 0; b < blocks; ++b) to[b] = tile.numbers + b * tile.block_stride;
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r)
      sum[c][r] = Lanes::load_aligned(to[r / block_registers] + c * tile.column_stride + r % block_registers * lanes);
  }
  for (int strip = first_strip; strip < end_strip; ++strip) {
    const int pivots = strip_width(front, strip);
    const long block = block_rows * pivots;
    const double* known_numbers = columns + strip_begin(front, strip) + (row_block - strip) * block;
    const double* scale = columns + strip_begin(front, strip) + (column_block - strip) * block + offset;
    for (int k = 0; k < pivots; ++k, known_numbers += block_rows, scale += block_rows) {
      Lanes known[registers];
      for (int r = 0; r < registers; ++r)
        known[r] = Lanes::load_aligned(known_numbers + r / block_registers * block + r % block_registers * lanes);
      for (int c = 0; c < width; ++c) {
        const Lanes factor(scale[c]);
        for (int r = 0; r < registers; ++r) sum[c][r] = fnma(factor, known[r], sum[c][r]);
      }
    }
  }
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r)
      sum[c][r].store_aligned(to[r / block_registers] + c * tile.column_stride + r % block_registers * lanes);
  }
}

using TakeStrips = void (*)(FrontShape, const double*, int, int, int, int, int, const Tile&);

template <int blocks, int... width>
constexpr TakeStrips take_strips_of(int columns, std::integer_sequence<int, width...>) {
  constexpr TakeStrips by_width[] = {take_strips<blocks, width + 1>...};
  return by_width[columns - 1];
}

// Describes a front while its pivots are eliminated. Column blocks are counted like row blocks: first the strips, then
// the columns of the update matrix in groups of eight.
struct DenseFront {
  FrontShape front;
  double *columns, *update;
  int strips, blocks;
  long update_stride;

  int columns_in(int block) const {
    if (block < strips) return strip_width(front, block);
    const int left = front.rows - (block - strips) * block_rows;
    return left < block_rows ? left : block_rows;
  }

  Tile tile(int row_block, int column_block) const {
    if (column_block < strips) {
      const long block = block_rows * strip_width(front, column_block);
      return {columns + strip_begin(front, column_block) + (row_block - column_block) * block, block, block_rows};
    }
    return {update + (column_block - strips) * block_rows * update_stride + (row_block - strips) * block_rows,
            block_rows, update_stride};
  }

  // Subtracts the strips from first_strip to end_strip from `count` row blocks (at most tile_blocks) of a column block.
  void take(int first_strip, int end_strip, int row_block, int count, int column_block) const {
    using Widths = std::make_integer_sequence<int, tile_columns>;
    const int width = columns_in(column_block);
    Tile at = tile(row_block, column_block);
    for (int offset = 0; offset < width; offset += tile_columns) {
      const int part = width - offset < tile_columns ? width - offset : tile_columns;
      const TakeStrips take_part = count == 1   ? take_strips_of<1>(part, Widths{})
                                   : count == 2 ? take_strips_of < tile_blocks < 2 ? 1 : 2 > (part, Widths{})
                                                : take_strips_of<tile_blocks>(part, Widths{});
      take_part(front, columns, first_strip, end_strip, row_block, column_block, offset, at);
      at.numbers += tile_columns * at.column_stride;
    }
  }
};

// Factors the triangle on a strip's diagonal; `inverse` gets the reciprocals of its diagonal. Returns the first pivot
// that is not positive, or -1.
int factor_triangle(double* triangle, int width, double* inverse) {
  for (int j = 0; j < width; ++j) {
    double* column = triangle + j * block_rows;
    for (int k = 0; k < j; ++k) {
      const double* known = triangle + k * block_rows;
      const Lanes factor(known[j]);
      for (int i = 0; i < block_rows; i += lanes)
        fnma(factor, Lanes::load_aligned(known + i), Lanes::load_aligned(column + i)).store_aligned(column + i);
    }
    if (!(column[j] > 0)) return j;
    const Lanes scale = Lanes(1.0) / sqrt(Lanes(column[j]));
    inverse[j] = scale.get(0);
    for (int i = 0; i < block_rows; i += lanes) (Lanes::load_aligned(column + i) * scale).store_aligned(column + i);
  }
  return -1;
}

// Turns the row blocks below the triangle, from which everything before the strip has been subtracted, into rows of L.
template <int width>
void finish_strip(const double* triangle, const double* inverse, double* block, int blocks) {
  for (int part = 0; part < blocks * block_registers; ++part) {
    double* numbers = block + part / block_registers * (block_rows * width) + part % block_registers * lanes;
    Lanes v[width];
    for (int j = 0; j < width; ++j) v[j] = Lanes::load_aligned(numbers + j * block_rows);
    for (int k = 0; k < width; ++k) {
      v[k] = v[k] * Lanes(inverse[k]);
      v[k].store_aligned(numbers + k * block_rows);
      for (int j = k + 1; j < width; ++j) v[j] = fnma(Lanes(triangle[k * block_rows + j]), v[k], v[j]);
    }
  }
}

int factor_strip(const DenseFront& e, int strip) {
  using FinishStrip = void (*)(const double*, const double*, double*, int);
  static constexpr FinishStrip finish[block_rows] = {finish_strip<1>, finish_strip<2>, finish_strip<3>,
                                                     finish_strip<4>, finish_strip<5>, finish_strip<6>,
                                                     finish_strip<7>, finish_strip<8>};
  double inverse[block_rows];
  const int width = strip_width(e.front, strip);
  double* triangle = e.columns + strip_begin(e.front, strip);
  const int failed = factor_triangle(triangle, width, inverse);
  if (failed >= 0) return strip * block_rows + failed;
  finish[width - 1](triangle, inverse, triangle + block_rows * width, e.blocks - strip - 1);
  return -1;
}

int eliminate(FrontShape front, double* columns, double* update) {
  const DenseFront e{front, columns, update, strips_of(front), row_blocks_of(front), padded_rows(front.rows)};
  for (int first = 0; first < e.strips; first += strips_together) {
    const int end = first + strips_together < e.strips ? first + strips_together : e.strips;
    for (int strip = first; strip < end; ++strip) {
      for (int row = strip; row < e.blocks && strip > first; row += tile_blocks)
        e.take(first, strip, row, e.blocks - row < tile_blocks ? e.blocks - row : tile_blocks, strip);
      const int failed = factor_strip(e, strip);
      if (failed >= 0) return failed;
    }
    for (int row = end; row < e.blocks; row += tile_blocks) {
      const int count = e.blocks - row < tile_blocks ? e.blocks - row : tile_blocks;
      for (int column = end; column < row; ++column) e.take(first, end, row, count, column);
      for (int below = 0; below < count; ++below) e.take(first, end, row + below, count - below, row + below);
    }
  }
  return -1;
}

void dots(const double* const* a, int count, const double* b, long begin, long end, double* result) {
  for (int i = 0; i < count; ++i) {
    const double* v = a[i];
    Lanes s0(0.0), s1(0.0), s2(0.0), s3(0.0);
    long at = begin;
    for (; at + 4 * lanes <= end; at += 4 * lanes) {
      s0 = fma(Lanes::load_unaligned(v + at), Lanes::load_unaligned(b + at), s0);
      s1 = fma(Lanes::load_unaligned(v + at + lanes), Lanes::load_unaligned(b + at + lanes), s1);
      s2 = fma(Lanes::load_unaligned(v + at + 2 * lanes), Lanes::load_unaligned(b + at + 2 * lanes), s2);
      s3 = fma(Lanes::load_unaligned(v + at + 3 * lanes), Lanes::load_unaligned(b + at + 3 * lanes), s3);
    }
    double sum = sum_in_order((s0 + s1) + (s2 + s3));
    for (; at < end; ++at) sum += v[at] * b[at];
    result[i] = sum;
  }
}

void add_scaled(const double* const* a, const double* c, int count, double* r, long begin, long end) {
  long at = begin;
  for (; at + lanes <= end; at += lanes) {
    Lanes sum = Lanes::load_unaligned(r + at);
    for (int i = 0; i < count; ++i) sum = fma(Lanes(c[i]), Lanes::load_unaligned(a[i] + at), sum);
    sum.store_unaligned(r + at);
  }
  for (; at < end; ++at) {
    for (int i = 0; i < count; ++i) r[at] += c[i] * a[i][at];
  }
}

template <bool with_squares>
void add_difference_rows(const DifferenceRows& matrix, const double* z, int begin, int end, double* products,
                         double* squares) {
  for (int i = begin; i < end; ++i) {
    Quad<double> own, sum{}, square{};
    load_row(z + 4 * long(i), own);
    for (std::int32_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
      Quad<double> other;
      load_row(z + 4 * long(matrix.column[k]), other);
      const Quad<double> apart = other - own, part = matrix.value[k] * apart;
      sum += part;
      if constexpr (with_squares) square += part * apart;
    }
    store_row(sum, products + 4 * long(i));
    if constexpr (with_squares) squares[i] = square[0] + square[1] + square[2];
  }
}

void difference_rows(const DifferenceRows& matrix, const double* z, int begin, int end, double* products,
                     double* squares) {
  if (squares != nullptr) return add_difference_rows<true>(matrix, z, begin, end, products, squares);
  add_difference_rows<false>(matrix, z, begin, end, products, nullptr);
}

}  // namespace

extern const LinearKernels SUPPLE_TABLE(linear);
const LinearKernels SUPPLE_TABLE(linear) = {
    eliminate, solve_down<float>, solve_up<float>, solve_down<double>, solve_up<double>,  down<float>,
    up<float>, down<double>,      up<double>,      down_many<float>,   down_many<double>, end_products,
    dots,      add_scaled,        difference_rows};

}  // namespace supple
