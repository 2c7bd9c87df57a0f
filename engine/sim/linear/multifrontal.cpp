#include "sim/linear/multifrontal.h"

#include <algorithm>

#include "sim/linear/linear_kernels.h"

namespace supple {
namespace {

// Returns the offset of a padded row in the column that begins a strip, counted from where row 0 would be.
std::int32_t place_in_strip(std::int32_t row, int width) {
  return (row & ~(block_rows - 1)) * width + (row & (block_rows - 1));
}

// Returns the address where the padded row 0 of a column would be.
double* column_of(FrontShape front, double* columns, int column) {
  const int strip = column / block_rows;
  return columns + strip_begin(front, strip) + column % block_rows * block_rows -
         std::int64_t(strip) * block_rows * strip_width(front, strip);
}

}  // namespace

void invert_triangles(FrontShape front, double* columns) {
  for (int strip = 0; strip < strips_of(front); ++strip) {
    double* triangle = columns + strip_begin(front, strip);
    const int width = strip_width(front, strip);
    double inverse[block_rows][block_rows] = {};  // by columns
    for (int j = 0; j < width; ++j) {
      inverse[j][j] = 1 / triangle[j * block_rows + j];
      for (int i = j + 1; i < width; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum += triangle[k * block_rows + i] * inverse[j][k];
        inverse[j][i] = -sum / triangle[i * block_rows + i];
      }
    }
    for (int j = 0; j < width; ++j) std::copy_n(inverse[j], block_rows, triangle + j * block_rows);
  }
}

Multifrontal::Multifrontal(const Elimination& elimination) : elimination_(elimination), place_(elimination.size) {
  waiting_.reserve(elimination.nodes.size());
  for (int i = 0; i < 2; ++i) stack_[i].resize(elimination.deepest_stack[i]);
}

void Multifrontal::begin() {
  waiting_.clear();
  stacked_[0] = stacked_[1] = 0;
}

int Multifrontal::eliminate(const Eigen::SparseMatrix<double>& matrix, int s, double* columns) {
  const Supernode& node = elimination_.nodes[s];
  std::int64_t& stacked = stacked_[node.level % 2];
  double* update = stack_[node.level % 2].data() + stacked;
  assemble(matrix, s, columns, update);
  const int failed = linear_kernels().eliminate(node.front(), columns, update);
  if (failed >= 0) return node.first + failed;
  stacked += update_numbers(node.front());
  if (node.parent >= 0) waiting_.push_back(s);
  return -1;
}

void Multifrontal::assemble(const Eigen::SparseMatrix<double>& matrix, int s, double* columns, double* update) {
  const Supernode& node = elimination_.nodes[s];
  const FrontShape front = node.front();
  std::fill_n(columns, column_numbers(front), 0.0);
  std::fill_n(update, update_numbers(front), 0.0);
  for (int j = 0; j < front.pivots; ++j) place_[node.first + j] = j;
  const std::int32_t* rows = elimination_.rows.data() + node.first_row;
  const int below = strips_of(front) * block_rows;
  for (int i = 0; i < front.rows; ++i) place_[rows[i]] = below + i;
  for (int j = 0; j < front.pivots; ++j) {
    const int width = strip_width(front, j / block_rows);
    double* column = column_of(front, columns, j);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, node.first + j); entry; ++entry) {
      if (entry.row() >= node.first + j) column[place_in_strip(place_[entry.row()], width)] = entry.value();
    }
  }
  while (!waiting_.empty() && elimination_.nodes[waiting_.back()].parent == s) {
    add_update(node, elimination_.nodes[waiting_.back()], columns, update);
    waiting_.pop_back();
  }
}

void Multifrontal::add_update(const Supernode& parent, const Supernode& child, double* columns, double* update) {
  const FrontShape front = parent.front();
  const std::int64_t stride = padded_rows(front.rows), child_stride = padded_rows(child.row_count);
  const int count = child.row_count;
  stacked_[child.level % 2] -= update_numbers(child.front());
  const double* from = stack_[child.level % 2].data() + stacked_[child.level % 2];
  const std::int32_t* rows = elimination_.rows.data() + child.first_row;
  target_.resize(count);
  in_strip_.resize(count);
  for (int i = 0; i < count; ++i) target_[i] = place_[rows[i]];
  int j = 0;
  double* first_column = nullptr;
  for (int strip = -1, width = 0; j < count && target_[j] < front.pivots; ++j, from += child_stride) {
    if (target_[j] / block_rows != strip) {
      strip = target_[j] / block_rows;
      first_column = column_of(front, columns, strip * block_rows);
      if (const int next = strip_width(front, strip); next != width) {
        width = next;
        for (int i = j; i < count; ++i) in_strip_[i] = place_in_strip(target_[i], width);
      }
    }
    double* column = first_column + target_[j] % block_rows * block_rows;
    for (int i = j; i < count; ++i) column[in_strip_[i]] += from[i];
  }
  const int first = strips_of(front) * block_rows;
  for (int i = j; i < count; ++i) target_[i] -= first;
  for (; j < count; ++j, from += child_stride) {
    double* column = update + target_[j] * stride;
    for (int i = j; i < count; ++i) column[target_[i]] += from[i];
  }
}

}  // namespace supple
