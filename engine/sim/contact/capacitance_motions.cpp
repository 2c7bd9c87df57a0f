// Adds motions to the small system of contacts, so that its matrix is C + W D W^T (capacitance.h).
#include <algorithm>

#include "sim/contact/capacitance.h"

namespace supple {
namespace {

// Calls work(part, its first column, their count) for each part on which a group acts.
template <class Work>
void for_parts(const GroupKey& key, const std::vector<int>& first_column, const Work& work) {
  for (const std::int32_t part : key) {
    if (part >= 0) work(part, first_column[part], first_column[part + 1] - first_column[part]);
  }
}

}  // namespace

// Finds the rows that new directions have in W and, of several parts, in W D.
void Capacitance::know_motions() {
  const std::uint64_t before = std::exchange(motions_of_, motions_ != nullptr ? motions_->pose : 0);
  is_changed_ |= before != motions_of_;
  if (motions_ == nullptr) return;
  const std::vector<int>& first_column = motions_->first_column;
  const int r = first_column.back();
  Eigen::VectorXd row = Eigen::VectorXd::Zero(r);
  if (!has_several_parts()) {
    if (before != motions_of_) {
      known_.clear();
      for (BlockFactor& factor : factors_) factor.forget_rows();
    }
    const std::size_t count = directions_.size();
    if (known_.size() < count || rows_.cols() != r) rows_.conservativeResize(static_cast<Eigen::Index>(count), r);
    known_.resize(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (known_[i] != 0) continue;
      motions_->add_row(directions_[i], row.setZero().data());
      rows_.row(static_cast<Eigen::Index>(i)) = row.cast<float>();
      known_[i] = 1;
    }
    return;
  }
  if (begin_.empty()) {
    begin_ = {0};
    row_.clear();
    row_times_.clear();
  }
  Eigen::VectorXd product;
  for (std::size_t i = begin_.size() - 1; i < directions_.size(); ++i) {
    motions_->add_row(directions_[i], row.data());
    for_parts(keys_[i], first_column, [&](int part, int first, int count) {
      if (count == 0) return;
      auto own = row.segment(first, count);
      product.noalias() = motions_->difference(part) * own;
      for (int k = 0; k < count; ++k) {
        row_.push_back(static_cast<float>(own[k]));
        row_times_.push_back(static_cast<float>(product[k]));
      }
      own.setZero();
    });
    begin_.push_back(row_.size());
  }
}

// Adds entries of W D W^T. All rows belong to one group, and all columns to one.
void Capacitance::add_products_of_motions(std::span<const Eigen::Index> rows, std::span<const Eigen::Index> columns,
                                          Eigen::Ref<RowMatrix> block) const {
  if (rows.empty() || columns.empty()) return;
  const GroupKey &key = keys_[rows[0]], &other = keys_[columns[0]];
  RowMatrix left, right;
  const auto gather = [&](int part, int count, std::span<const Eigen::Index> members, const std::vector<float>& numbers,
                          RowMatrix& matrix) {
    std::size_t before = 0;
    for_parts(keys_[members[0]], motions_->first_column, [&](int earlier, int, int more) {
      if (earlier < part) before += std::size_t(more);
    });
    matrix.resize(std::ssize(members), count);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      matrix.row(i) = Eigen::Map<const Eigen::RowVectorXf>(&numbers[begin_[members[i]] + before], count);
  };
  for_parts(key, motions_->first_column, [&](int part, int, int count) {
    if (count == 0 || std::find(other.begin(), other.end(), part) == other.end()) return;
    gather(part, count, rows, row_times_, left);
    gather(part, count, columns, row_, right);
    block.noalias() += left * right.transpose();
  });
}

// Prepares solves with motions for a body alone.
void Capacitance::couple_motions() {
  if (motions_ == nullptr || has_several_parts() || !std::exchange(is_changed_, false)) return;
  const int r = motions_->first_column.back();
  are_few_ = 4 * std::ssize(directions_) < 3 * r;
  if (are_few_) return couple_few();
  between_.setZero(r, r);
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    factors_[i].multiply_rows(rows_);
    factors_[i].add_product(between_);
  }
  between_.triangularView<Eigen::StrictlyUpper>() = between_.transpose();
  both_.compute(Eigen::MatrixXd::Identity(r, r) + motions_->difference(0) * between_);
}

// Makes the factor of 1 + V D V^T with V = L^-1 W. Where a body turns, W D W^T is far larger than C, so this is in
// double precision. For n directions in one list it takes about n r^2 + 3/2 n^2 r + n^3 / 3 multiplications; the other
// form takes (n r^2 + n^2 r) / 2 + 4/3 r^3.
void Capacitance::couple_few() {
  Eigen::MatrixXd v = rows_.topRows(std::ssize(directions_)).cast<double>();
  for (std::size_t i = 0; i < lists_.size(); ++i) factors_[i].solve_lower(v);
  between_.noalias() = v * motions_->difference(0) * v.transpose();
  between_.diagonal().array() += 1;
  both_.compute(between_);
}

void Capacitance::solve_few(Eigen::VectorXf& answer) const {
  Eigen::VectorXd numbers = answer.cast<double>();
  for (std::size_t i = 0; i < lists_.size(); ++i) factors_[i].solve_lower(numbers);
  numbers = both_.solve(numbers).eval();
  for (std::size_t i = 0; i < lists_.size(); ++i) factors_[i].solve_upper(numbers);
  answer = numbers.cast<float>();
}

void Capacitance::solve(Eigen::VectorXf& answer) const {
  const bool has_motions = motions_ != nullptr && !has_several_parts();
  if (has_motions && are_few_) return solve_few(answer);
  const auto solve_without = [this](Eigen::VectorXf& numbers) {
    for (std::size_t i = 0; i < lists_.size(); ++i) factors_[i].solve(numbers);
  };
  solve_without(answer);
  if (!has_motions) return;
  const Eigen::VectorXd seen = (rows_.transpose() * answer).cast<double>();
  const Eigen::VectorXd product = motions_->difference(0) * seen;
  Eigen::VectorXf back = rows_ * both_.solve(product).cast<float>();
  solve_without(back);
  answer -= back;
}

Eigen::VectorXf Capacitance::seen_by_directions(const Eigen::VectorXd& y) const {
  if (!has_several_parts()) return rows_ * y.cast<float>();
  Eigen::VectorXf seen(std::ssize(directions_));
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    double sum = 0;
    std::size_t at = begin_[i];
    for_parts(keys_[i], motions_->first_column, [&](int, int first, int count) {
      for (int k = 0; k < count; ++k) sum += static_cast<double>(row_[at++]) * y[first + k];
    });
    seen[static_cast<Eigen::Index>(i)] = static_cast<float>(sum);
  }
  return seen;
}

Eigen::VectorXd Capacitance::seen_by_motions(const Eigen::VectorXf& f) const {
  if (!has_several_parts()) return (rows_.transpose() * f).cast<double>();
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(motions_->first_column.back());
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const auto force = static_cast<double>(f[static_cast<Eigen::Index>(i)]);
    std::size_t at = begin_[i];
    for_parts(keys_[i], motions_->first_column, [&](int, int first, int count) {
      for (int k = 0; k < count; ++k) sums[first + k] += static_cast<double>(row_[at++]) * force;
    });
  }
  return sums;
}

// Moves the rows of directions that stay to where these are now.
void Capacitance::keep_rows(const std::vector<Eigen::Index>& place) {
  if (motions_of_ == 0 || has_several_parts()) return;
  RowMatrix rows(std::ssize(directions_), rows_.cols());
  std::vector<char> known(directions_.size(), 0);
  for (std::size_t i = 0; i < std::min(place.size(), known_.size()); ++i) {
    if (place[i] < 0 || known_[i] == 0) continue;
    rows.row(place[i]) = rows_.row(static_cast<Eigen::Index>(i));
    known[place[i]] = 1;
  }
  rows_.swap(rows);
  known_.swap(known);
}

}  // namespace supple
