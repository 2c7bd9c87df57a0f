// Solves in double precision with the factor of a C with one group (block_factor.h), and makes W^T C^-1 W from it: L^-1
// W, and the products of its rows.
#include <algorithm>

#include "sim/contact/block_factor.h"

namespace supple {
namespace {

// Solves in place for some rows with the lower triangle of a matrix, or with its transpose.
void solve_rows(const BlockFactor::RowMatrix& lower, bool is_transposed, const BlockFactor::Members& rows,
                Eigen::Ref<Eigen::MatrixXd> numbers) {
  const auto n = std::ssize(rows);
  const Eigen::MatrixXd triangle = lower.topLeftCorner(n, n).cast<double>();
  Eigen::MatrixXd own = numbers(rows, Eigen::all);
  if (is_transposed) {
    triangle.triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  } else {
    triangle.triangularView<Eigen::Lower>().solveInPlace(own);
  }
  numbers(rows, Eigen::all) = own;
}

}  // namespace

void BlockFactor::solve_lower(Eigen::Ref<Eigen::MatrixXd> numbers) const {
  for (const Column& column : columns_) solve_rows(column.lower, false, column.members, numbers);
}

void BlockFactor::solve_upper(Eigen::Ref<Eigen::MatrixXd> numbers) const {
  for (const Column& column : columns_) solve_rows(column.lower, true, column.members, numbers);
}

void BlockFactor::forget_rows() {
  for (Column& column : columns_) column.keep_rows(0);
}

void BlockFactor::multiply_rows(const RowMatrix& rows) {
  for (Column& column : columns_) {
    see_rows(rows, column);
    sum_product(column);
  }
}

void BlockFactor::see_rows(const RowMatrix& rows, Column& column) {
  const Eigen::Index n = column.size(), first = column.seen_members, more = n - first, r = rows.cols();
  if (column.seen.rows() < n || column.seen.cols() != r) column.seen.conservativeResize(n + n / 2, r);
  column.seen_members = n;
  if (more == 0 || r == 0) return;
  auto added = column.seen.middleRows(first, more);
  for (Eigen::Index i = 0; i < more; ++i) added.row(i) = rows.row(column.members[first + i]);
  if (first > 0) added.noalias() -= column.lower.block(first, 0, more, first) * column.seen.topRows(first);
  column.lower.block(first, first, more, more).triangularView<Eigen::Lower>().solveInPlace(added);
}

void BlockFactor::sum_product(Column& column) {
  const Eigen::Index n = column.size(), r = column.seen.cols();
  if (column.summed == n && column.has_product) return;
  if (column.summed == 0) column.product.setZero(r, r);
  const Eigen::Index more = n - column.summed;
  if (more > 0 && r > 0)
    column.product.selfadjointView<Eigen::Lower>().rankUpdate(column.seen.middleRows(column.summed, more).transpose());
  column.summed = n;
  column.has_product = true;
}

void BlockFactor::add_product(Eigen::MatrixXd& sum) const {
  for (const Column& column : columns_) {
    for (Eigen::Index j = 0; j < sum.cols(); ++j)
      for (Eigen::Index i = j; i < sum.rows(); ++i) sum(i, j) += static_cast<double>(column.product(i, j));
  }
}

}  // namespace supple
