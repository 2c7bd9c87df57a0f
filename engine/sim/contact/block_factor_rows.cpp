// Makes W^T C^-1 W from the factor of C (block_factor.h): L^-1 W group by group, and the products of its rows. The rows
// of a group have only the columns of the parts that act on it.
#include <algorithm>

#include "sim/contact/block_factor.h"

namespace supple {
namespace {

// Calls work(own, other, count) for each of some parts: where its columns of W begin among those of these parts, where
// among those of a sorted list of parts that contains them, and how many they are.
template <class Work>
void match_parts(const std::vector<int>& parts, const std::vector<int>& among, const std::vector<int>& first_column,
                 const Work& work) {
  int own = 0, other = 0;
  std::size_t k = 0;
  for (const int part : parts) {
    for (; among[k] != part; ++k) other += first_column[among[k] + 1] - first_column[among[k]];
    const int count = first_column[part + 1] - first_column[part];
    work(own, other, count);
    own += count;
  }
}

int columns_of(const std::vector<int>& parts, const std::vector<int>& first_column) {
  int sum = 0;
  for (const int part : parts) sum += first_column[part + 1] - first_column[part];
  return sum;
}

}  // namespace

void BlockFactor::forget_rows() {
  for (Column& column : columns_) column.keep_rows(0);
}

bool BlockFactor::multiply_rows(const RowMatrix& rows, const std::vector<int>& first_column, Threads* threads) {
  bool any = false;
  std::vector<char> is_new;
  for (const std::vector<int>& level : levels_) {
    long work = 0;
    for (const int group : level)
      work += operations(group) / std::max<long>(columns_[group].size(), 1) *
              columns_of(columns_[group].parts, first_column) / 16;
    is_new.assign(level.size(), 0);
    run_chunks(threads, static_cast<int>(level.size()), work, [&](int k) {
      see_rows(level[k], rows, first_column);
      is_new[k] = sum_product(level[k]);
    });
    any |= std::find(is_new.begin(), is_new.end(), 1) != is_new.end();
  }
  return any;
}

void BlockFactor::see_rows(int group, const RowMatrix& rows, const std::vector<int>& first_column) {
  Column& column = columns_[group];
  const Eigen::Index n = column.size(), first = column.seen_members, more = n - first;
  const Eigen::Index r = columns_of(column.parts, first_column);
  if (column.seen.rows() < n || column.seen.cols() != r) column.seen.conservativeResize(n + n / 2, r);
  if (more == 0 || r == 0) {
    column.seen_members = n;
    return;
  }
  auto added = column.seen.middleRows(first, more);
  int to = 0;
  for (const int part : column.parts) {
    const int from = first_column[part], count = first_column[part + 1] - from;
    for (Eigen::Index i = 0; i < more; ++i)
      added.row(i).segment(to, count) = rows.row(column.members[first + i]).segment(from, count);
    to += count;
  }
  if (first > 0) added.noalias() -= column.lower.block(first, 0, more, first) * column.seen.topRows(first);
  RowMatrix product;
  for (const Update& update : updates_[group]) {
    const Column& earlier = columns_[update.column];
    const Eigen::Index size = earlier.size();
    if (size == 0 || earlier.seen.cols() == 0) continue;
    product.noalias() = earlier.below[update.block].numbers.block(first, 0, more, size) * earlier.seen.topRows(size);
    match_parts(earlier.parts, column.parts, first_column,
                [&](int from, int at, int count) { added.middleCols(at, count) -= product.middleCols(from, count); });
  }
  column.lower.block(first, first, more, more).triangularView<Eigen::Lower>().solveInPlace(added);
  column.seen_members = n;
}

bool BlockFactor::sum_product(int group) {
  Column& column = columns_[group];
  const Eigen::Index n = column.size(), r = column.seen.cols();
  if (column.summed == n && column.has_product) return false;
  if (column.summed == 0) column.product.setZero(r, r);
  const Eigen::Index more = n - column.summed;
  if (more > 0 && r > 0)
    column.product.selfadjointView<Eigen::Lower>().rankUpdate(column.seen.middleRows(column.summed, more).transpose());
  column.summed = n;
  column.has_product = true;
  return true;
}

void BlockFactor::add_product(const std::vector<int>& first_column, Eigen::MatrixXd& sum) const {
  std::vector<int> place;
  for (const Column& column : columns_) {
    place.clear();
    for (const int part : column.parts) {
      for (int c = first_column[part]; c < first_column[part + 1]; ++c) place.push_back(c);
    }
    for (std::size_t j = 0; j < place.size(); ++j) {
      for (std::size_t i = j; i < place.size(); ++i)
        sum(place[i], place[j]) +=
            static_cast<double>(column.product(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
}

}  // namespace supple
