// Defines how the numbers of a front are stored. The eliminated columns, with all their rows, are divided into strips
// of up to eight columns. A strip is stored in blocks of eight rows, from the block of its diagonal down, and each
// block by columns, so a strip is one run of memory, for elimination and for solves. Row blocks of the eliminated
// columns come first (the last one is padded with zeros), then those of the rows below, which are padded as well. The
// update matrix is what elimination leaves of the other columns; its lower triangle is stored by columns of
// padded_rows(rows) numbers.
//
// The functions have internal linkage, because files that are compiled for several instruction sets include them.
#pragma once

#include <cstdint>

namespace supple {

constexpr int block_rows = 8;  // and the most columns of a strip

// Returns the leading dimension of an update matrix with so many rows: whole cache lines.
static constexpr std::int64_t padded_rows(std::int64_t rows) {
  return (rows + block_rows - 1) / block_rows * block_rows;
}

struct FrontShape {
  int pivots;  // columns that are eliminated
  int rows;    // below them; rows and columns of the update matrix
};

static constexpr int strips_of(FrontShape front) { return (front.pivots + block_rows - 1) / block_rows; }
static constexpr int row_blocks_of(FrontShape front) {
  return strips_of(front) + (front.rows + block_rows - 1) / block_rows;
}
static constexpr int strip_width(FrontShape front, int strip) {
  const int left = front.pivots - strip * block_rows;
  return left < block_rows ? left : block_rows;
}

// Returns the offset of a strip's diagonal block among the numbers of the eliminated columns.
static constexpr std::int64_t strip_begin(FrontShape front, int strip) {
  const std::int64_t blocks = std::int64_t(strip) * row_blocks_of(front) - std::int64_t(strip) * (strip - 1) / 2;
  return block_rows * block_rows * blocks;
}

// Counts the numbers of the eliminated columns.
static constexpr std::int64_t column_numbers(FrontShape front) {
  const int last = strips_of(front) - 1;
  return strip_begin(front, last) + std::int64_t(block_rows) * strip_width(front, last) * (row_blocks_of(front) - last);
}

// Counts the numbers of the update matrix.
static constexpr std::int64_t update_numbers(FrontShape front) { return padded_rows(front.rows) * front.rows; }

// Returns the index of a front's row among the padded ones: the rows of the eliminated columns come first.
static constexpr int padded_place(FrontShape front, int row) {
  return row < front.pivots ? row : strips_of(front) * block_rows + row - front.pivots;
}

}  // namespace supple
