#include "sim/linear/changing_factor.h"

#include <algorithm>

#include "sim/linear/linear_kernels.h"

namespace supple {

void ChangingFactor::analyze(const Eigen::SparseMatrix<double>& matrix) {
  elimination_ = std::make_unique<Elimination>(Elimination::of(matrix));
  fronts_ = std::make_unique<Multifrontal>(*elimination_);
  first_number_.clear();
  std::int64_t count = 0, most_rows = 0;
  for (const Supernode& node : elimination_->nodes) {
    first_number_.push_back(count);
    count += column_numbers(node.front());
    most_rows = std::max<std::int64_t>(most_rows, row_blocks_of(node.front()) * block_rows);
  }
  if (precision_ == Precision::double_precision) {
    double_.resize(count);
    scratch_.resize(most_rows);
    return;
  }
  single_.resize(count);
  front_.resize(elimination_->most_column_numbers);
  narrow_.resize(most_rows);
  x_.resize(elimination_->size);
}

bool ChangingFactor::factorize(const Eigen::SparseMatrix<double>& matrix) {
  fronts_->begin();
  for (const std::int32_t s : elimination_->order) {
    const bool narrow = precision_ == Precision::single_precision;
    const FrontShape front = elimination_->nodes[s].front();
    double* columns = narrow ? front_.data() : double_.data() + first_number_[s];
    if (fronts_->eliminate(matrix, s, columns) >= 0) return false;
    invert_triangles(front, columns);
    if (narrow) std::copy_n(columns, column_numbers(front), single_.data() + first_number_[s]);
  }
  return true;
}

double ChangingFactor::operations() const { return elimination_->operations(); }

template <class T>
void ChangingFactor::solve_in_place(const AlignedVector<T>& columns, T* x, T* scratch) const {
  const Elimination& all = *elimination_;
  const auto each = [&](const auto& step, int s) {
    const Supernode& node = all.nodes[s];
    step(node.front(), columns.data() + first_number_[s], all.rows.data() + node.first_row, x + node.first, x, scratch);
  };
  const auto count = static_cast<int>(all.nodes.size());
  const LinearKernels& kernels = linear_kernels();
  if constexpr (std::is_same_v<T, float>) {
    for (int s = 0; s < count; ++s) each(kernels.front_down_float, s);
    for (int s = count - 1; s >= 0; --s) each(kernels.front_up_float, s);
  } else {
    for (int s = 0; s < count; ++s) each(kernels.front_down_double, s);
    for (int s = count - 1; s >= 0; --s) each(kernels.front_up_double, s);
  }
}

void ChangingFactor::solve(const double* b, double* x) {
  const int size = elimination_->size;
  if (precision_ == Precision::double_precision) {
    if (x != b) std::copy_n(b, size, x);
    solve_in_place(double_, x, scratch_.data());
    return;
  }
  const double scale = solve_scale(b, size), back = 1 / scale;
  for (int i = 0; i < size; ++i) x_[i] = static_cast<float>(scale * b[i]);
  solve_in_place(single_, x_.data(), narrow_.data());
  for (int i = 0; i < size; ++i) x[i] = back * x_[i];
}

}  // namespace supple
