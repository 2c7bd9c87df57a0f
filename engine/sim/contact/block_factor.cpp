#include "sim/contact/block_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>

namespace supple {
namespace {

// Ensures that a matrix has room for rows and columns; keeps its first ones.
void make_room(Eigen::MatrixXf& numbers, Eigen::Index rows, Eigen::Index columns, Eigen::Index kept_rows,
               Eigen::Index kept_columns) {
  if (numbers.rows() >= rows && numbers.cols() >= columns) return;
  Eigen::MatrixXf larger(rows + rows / 4, columns + columns / 4);
  if (kept_rows > 0) larger.topLeftCorner(kept_rows, kept_columns) = numbers.topLeftCorner(kept_rows, kept_columns);
  numbers.swap(larger);
}

// Solves X L^T = B in place. Eigen's own function works number by number in panels of 48.
template <class Lower>
void solve_from_right(const Lower& lower, Eigen::Ref<Eigen::MatrixXf> b) {
  constexpr Eigen::Index width = 16;
  for (Eigen::Index first = 0; first < b.cols(); first += width) {
    const Eigen::Index end = std::min(first + width, b.cols());
    if (first > 0)
      b.middleCols(first, end - first).noalias() -=
          b.leftCols(first) * lower.block(first, 0, end - first, first).transpose();
    for (Eigen::Index j = first; j < end; ++j) {
      if (j > first)
        b.col(j).noalias() -= b.middleCols(first, j - first) * lower.row(j).segment(first, j - first).transpose();
      b.col(j) /= lower(j, j);
    }
  }
}

}  // namespace

void BlockFactor::Column::keep(Eigen::Index count) {
  factored = std::min(factored, count);
  keep_rows(count);
}

void BlockFactor::Column::keep_rows(Eigen::Index count) {
  seen_members = std::min(seen_members, count);
  if (summed > count || count == 0) {
    summed = 0;
    has_product = false;
  }
}

void BlockFactor::begin(const Members& members, const std::vector<GroupKey>& keys) { replace(members, keys, {}); }

// A single column keeps its memory. Several columns give theirs up: the shape of a matrix that an earlier step has left
// must not decide how the sums of products of small matrices are made.
void BlockFactor::begin(std::vector<GroupKey> keys, std::vector<Members> members) {
  std::vector<Eigen::Index> sizes;
  for (const Members& group : members) sizes.push_back(std::ssize(group));
  const std::vector<int> order = elimination_order(keys, sizes);
  columns_.resize(ordered_ = order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    Column& column = columns_[k];
    column.key = keys[order[k]];
    column.members = std::move(members[order[k]]);
    column.below.clear();
    if (order.size() > 1) column.lower.resize(0, 0);
    column.keep(0);
  }
  is_linked_ = false;
}

// Columns whose group has no members any more stay, and cost nothing. If a group is new, all are put into a new order.
void BlockFactor::replace(const Members& members, const std::vector<GroupKey>& keys,
                          const std::vector<Eigen::Index>& place) {
  std::map<GroupKey, std::size_t> numbers;
  std::vector<GroupKey> group_keys;
  std::vector<Members> groups;
  std::size_t group = 0;
  for (const Eigen::Index member : members) {
    const GroupKey& key = keys[member];
    if (groups.empty() || key != group_keys[group]) group = numbers.try_emplace(key, groups.size()).first->second;
    if (group == groups.size()) {
      group_keys.push_back(key);
      groups.emplace_back();
    }
    groups[group].push_back(member);
  }
  if (columns_.size() > ordered_) is_linked_ = false;
  columns_.resize(std::min(columns_.size(), ordered_));
  std::size_t present = 0;
  for (const Column& column : columns_) present += numbers.count(column.key);
  if (place.empty() || present < groups.size()) return begin(std::move(group_keys), std::move(groups));
  std::vector<Eigen::Index> kept;
  for (Column& column : columns_) {
    const auto at = numbers.find(column.key);
    Members now = at != numbers.end() ? std::move(groups[at->second]) : Members();
    Eigen::Index same = 0;
    const auto most = static_cast<Eigen::Index>(std::min(column.members.size(), now.size()));
    while (same < most && place[column.members[same]] == now[same]) ++same;
    if (same < column.size()) column.is_new = true;
    column.members = std::move(now);
    column.keep(same);
    kept.push_back(same);
  }
  for (Column& column : columns_) {
    std::erase_if(column.below, [&](const Block& block) { return block.group >= std::ssize(columns_); });
    for (Block& block : column.below) block.known = std::min(block.known, kept[block.group]);
  }
}

void BlockFactor::append(Eigen::Index member, const GroupKey& key) {
  const auto has_key = [&](const Column& column) { return column.key == key; };
  const bool is_dense = columns_.size() == 1 && has_key(columns_[0]);
  auto at = std::find_if(columns_.begin() + (is_dense ? 0 : std::ptrdiff_t(ordered_)), columns_.end(), has_key);
  if (at == columns_.end()) {
    at = columns_.emplace(at);
    at->key = key;
    is_linked_ = false;
  }
  at->members.push_back(member);
}

// The columns of what was appended are dense where the groups hang together. Where they cost more than all others, all
// members are put into the order of their groups.
void BlockFactor::begin_if_appended_cost_much() {
  long ordered = 0, appended = 0;
  for (std::size_t g = 0; g < columns_.size(); ++g)
    (g < ordered_ ? ordered : appended) += operations(static_cast<int>(g));
  if (appended <= ordered) return;
  std::vector<GroupKey> keys;
  std::vector<Members> groups;
  for (Column& column : columns_) {
    if (column.members.empty()) continue;
    const auto at = static_cast<std::size_t>(std::find(keys.begin(), keys.end(), column.key) - keys.begin());
    if (at == keys.size()) {
      keys.push_back(column.key);
      groups.emplace_back();
    }
    groups[at].insert(groups[at].end(), column.members.begin(), column.members.end());
  }
  begin(std::move(keys), std::move(groups));
  link();
}

// Finds which blocks there are; those that are known already stay.
void BlockFactor::link() {
  if (is_linked_) return;
  is_linked_ = true;
  std::vector<GroupKey> keys;
  for (const Column& column : columns_) keys.push_back(column.key);
  const std::vector<std::vector<int>> below = blocks_below(keys);
  const int count = static_cast<int>(columns_.size());
  updates_.assign(columns_.size(), {});
  levels_.clear();
  std::vector<std::size_t> level(columns_.size(), 0);
  for (int g = 0; g < count; ++g) {
    Column& column = columns_[g];
    std::vector<Block> blocks;
    auto old = column.below.begin();
    for (const int group : below[g]) {
      updates_[group].push_back({g, static_cast<int>(blocks.size())});
      if (old != column.below.end() && old->group == group) {
        blocks.push_back(std::move(*old++));
      } else {
        blocks.push_back({group, {}, 0});
      }
    }
    column.below.swap(blocks);
    for (const Update& update : updates_[g]) level[g] = std::max(level[g], level[update.column] + 1);
    if (level[g] == levels_.size()) levels_.emplace_back();
    levels_[level[g]].push_back(g);
  }
}

// Returns how many operations are needed to compute a column anew.
long BlockFactor::operations(int group) const {
  const long own = columns_[group].size();
  long rows = own, width = own;
  for (const Block& block : columns_[group].below) rows += columns_[block.group].size();
  for (const Update& update : updates_[group]) width += columns_[update.column].size();
  return own * rows * width;
}

long BlockFactor::work() const {
  long sum = 0;
  for (const Column& column : columns_) sum += column.size() * column.size() * (column.size() - column.factored);
  return sum / 16;
}

bool BlockFactor::compute(const Fill& fill, Threads* threads) {
  link();
  if (columns_.size() > ordered_) begin_if_appended_cost_much();
  std::vector<char> done;
  std::vector<std::pair<int, Block*>> blocks;
  for (const std::vector<int>& level : levels_) {
    long work = 0;
    blocks.clear();
    for (const int group : level) {
      work += operations(group) / 16;
      for (Block& block : columns_[group].below) blocks.emplace_back(group, &block);
    }
    done.assign(level.size(), 0);
    run_chunks(threads, static_cast<int>(level.size()), work,
               [&](int k) { done[k] = factor_diagonal(level[k], fill); });
    if (std::find(done.begin(), done.end(), 0) != done.end()) return false;
    run_chunks(threads, static_cast<int>(blocks.size()), work,
               [&](int k) { factor_block(blocks[k].first, *blocks[k].second, fill); });
  }
  for (Column& column : columns_) column.is_new = false;
  return true;
}

// Subtracts from entries between members of a group and of a column what earlier columns have in both. target: the
// entries from first_row and first_column on.
void BlockFactor::subtract_updates(int column, int group, Eigen::Index first_row, Eigen::Index first_column,
                                   Eigen::Ref<Eigen::MatrixXf> target) const {
  for (const Update& update : updates_[column]) {
    const Column& earlier = columns_[update.column];
    const auto from = earlier.below.begin() + update.block;
    const auto at = std::lower_bound(from, earlier.below.end(), group,
                                     [](const Block& block, int number) { return block.group < number; });
    if (at == earlier.below.end() || at->group != group || earlier.size() == 0) continue;
    target.noalias() -= at->numbers.block(first_row, 0, target.rows(), earlier.size()) *
                        from->numbers.block(first_column, 0, target.cols(), earlier.size()).transpose();
  }
}

bool BlockFactor::factor_diagonal(int group, const Fill& fill) {
  Column& column = columns_[group];
  const bool is_acted_on = std::any_of(updates_[group].begin(), updates_[group].end(),
                                       [&](const Update& update) { return columns_[update.column].is_new; });
  if (is_acted_on) {
    column.is_new = true;
    column.keep(0);
    for (Block& block : column.below) block.known = 0;
  }
  const Eigen::Index n = column.size(), first = column.first = column.factored, more = n - first;
  if (more == 0) return true;
  column.is_new = true;
  RowMatrix& lower = column.lower;
  if (lower.rows() < n) {
    RowMatrix larger = RowMatrix::Zero(n + n / 2, n + n / 2);
    larger.topLeftCorner(first, first) = lower.topLeftCorner(first, first);
    lower.swap(larger);
  }
  const std::span<const Eigen::Index> members(column.members);
  fill(members.subspan(first), members, first, lower.block(first, 0, more, n));
  auto below = lower.block(first, 0, more, first);
  auto corner = lower.block(first, first, more, more);
  for (const Update& update : updates_[group]) {
    const Column& earlier = columns_[update.column];
    if (earlier.size() == 0) continue;
    const Eigen::MatrixXf& numbers = earlier.below[update.block].numbers;
    const auto rows = numbers.block(first, 0, more, earlier.size());
    if (first > 0) below.noalias() -= rows * numbers.topLeftCorner(first, earlier.size()).transpose();
    corner.selfadjointView<Eigen::Lower>().rankUpdate(rows, -1);
  }
  if (first > 0) {
    auto right = below.transpose();
    lower.topLeftCorner(first, first).triangularView<Eigen::Lower>().solveInPlace(right);
    corner.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  }
  const Eigen::LLT<Eigen::Ref<RowMatrix>> done(corner);
  column.factored = n;
  return done.info() == Eigen::Success;
}

// Computes, in rows that are known, the entries of the column's new members, and in other rows those of all members.
void BlockFactor::factor_block(int group, Block& block, const Fill& fill) const {
  const Column& column = columns_[group];
  const Members& members = columns_[block.group].members;
  const auto rows = static_cast<Eigen::Index>(members.size()), n = column.size();
  make_room(block.numbers, rows, n, block.known, column.first);
  const auto compute_rows = [&](Eigen::Index first_row, Eigen::Index count, Eigen::Index first) {
    if (count == 0 || first == n) return;
    auto target = block.numbers.block(first_row, first, count, n - first);
    Eigen::Map<RowMatrix, 0, Eigen::OuterStride<>> transposed(target.data(), n - first, count,
                                                              Eigen::OuterStride<>(target.outerStride()));
    fill(std::span(column.members).subspan(first), std::span(members).subspan(first_row, count), count, transposed);
    subtract_updates(group, block.group, first_row, first, target);
    if (first > 0)
      target.noalias() -=
          block.numbers.block(first_row, 0, count, first) * column.lower.block(first, 0, n - first, first).transpose();
    solve_from_right(column.lower.block(first, first, n - first, n - first), target);
  };
  compute_rows(0, block.known, column.first);
  compute_rows(block.known, rows - block.known, 0);
  block.known = rows;
}

void BlockFactor::solve(Eigen::VectorXf& numbers) const {
  std::vector<Eigen::VectorXf> parts(columns_.size());
  for (std::size_t g = 0; g < columns_.size(); ++g) parts[g] = numbers(columns_[g].members);
  for (std::size_t g = 0; g < columns_.size(); ++g) {
    const Column& column = columns_[g];
    const Eigen::Index n = column.size();
    if (n == 0) continue;
    column.lower.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(parts[g]);
    for (const Block& block : column.below)
      parts[block.group].noalias() -= block.numbers.topLeftCorner(block.known, n) * parts[g];
  }
  for (std::size_t g = columns_.size(); g-- > 0;) {
    const Column& column = columns_[g];
    const Eigen::Index n = column.size();
    if (n == 0) continue;
    for (const Block& block : column.below)
      parts[g].noalias() -= block.numbers.topLeftCorner(block.known, n).transpose() * parts[block.group];
    column.lower.topLeftCorner(n, n).triangularView<Eigen::Lower>().transpose().solveInPlace(parts[g]);
    numbers(column.members) = parts[g];
  }
}

}  // namespace supple
