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
  columns_.resize(count);
  scratch_.resize(most_rows);
}

bool ChangingFactor::factorize(const Eigen::SparseMatrix<double>& matrix) {
  fronts_->begin();
  for (const std::int32_t s : elimination_->order) {
    if (fronts_->eliminate(matrix, s, columns_.data() + first_number_[s]) >= 0) return false;
  }
  return true;
}

void ChangingFactor::solve(const double* b, double* x) {
  const Elimination& all = *elimination_;
  if (x != b) std::copy_n(b, all.size, x);
  const LinearKernels& kernels = linear_kernels();
  const auto each = [&](const auto& step, int s) {
    const Supernode& node = all.nodes[s];
    step(node.front(), columns_.data() + first_number_[s], all.rows.data() + node.first_row, x + node.first, x,
         scratch_.data());
  };
  const int count = static_cast<int>(all.nodes.size());
  for (int s = 0; s < count; ++s) each(kernels.solve_down, s);
  for (int s = count - 1; s >= 0; --s) each(kernels.solve_up, s);
}

}  // namespace supple
