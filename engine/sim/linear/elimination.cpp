#include "sim/linear/elimination.h"

#include <algorithm>
#include <numeric>

namespace supple {
namespace {

// Holds the rows of each column of the factor below its diagonal, ascending: those of the matrix's column, and those of
// all columns whose first row below the diagonal is the column's own.
struct ColumnPatterns {
  std::vector<std::int64_t> begin{0};
  std::vector<std::int32_t> rows;

  int below(int j) const { return static_cast<int>(begin[j + 1] - begin[j]); }
  int parent(int j) const { return below(j) > 0 ? rows[begin[j]] : -1; }
};

ColumnPatterns column_patterns(const Eigen::SparseMatrix<double>& matrix) {
  const int size = static_cast<int>(matrix.cols());
  ColumnPatterns patterns;
  patterns.begin.reserve(size + 1);
  std::vector<std::int32_t> seen_by(size, -1), first_child(size, -1), next_child(size, -1), column;
  for (int j = 0; j < size; ++j) {
    column.clear();
    seen_by[j] = j;
    const auto see = [&](std::int32_t row) {
      if (seen_by[row] == j) return;
      seen_by[row] = j;
      column.push_back(row);
    };
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, j); entry; ++entry) {
      if (entry.row() > j) see(entry.row());
    }
    for (int child = first_child[j]; child >= 0; child = next_child[child]) {
      for (std::int64_t at = patterns.begin[child] + 1; at < patterns.begin[child + 1]; ++at) see(patterns.rows[at]);
    }
    std::sort(column.begin(), column.end());
    patterns.rows.insert(patterns.rows.end(), column.begin(), column.end());
    patterns.begin.push_back(static_cast<std::int64_t>(patterns.rows.size()));
    if (const int parent = patterns.parent(j); parent >= 0) {
      next_child[j] = first_child[parent];
      first_child[parent] = j;
    }
  }
  return patterns;
}

// Tells whether a child is merged into its parent: as long as few zeros are stored because of that. The thresholds are
// CHOLMOD's (nrelax, zrelax); the times of our solves confirm them to within noise, and so do those of 3n x 3n factors,
// where wider merging is no faster either.
bool worth_merging(int wide, std::int64_t dense, std::int64_t nonzeros) {
  const double zeros = static_cast<double>(dense - nonzeros) / static_cast<double>(dense);
  return zeros <= 0 || wide <= 4 || (wide <= 16 && zeros < 0.8) || (wide <= 48 && zeros < 0.1) || zeros < 0.05;
}

void find_supernodes(const ColumnPatterns& columns, Elimination& out) {
  std::vector<std::int64_t> nonzeros;  // by supernode, without the zeros that merging stores
  for (int j = 0; j < out.size; ++j) {
    Supernode node{j, j, 0, 0, -1, 0};
    std::int64_t own = columns.below(j) + 1;
    while (!out.nodes.empty() && columns.parent(out.nodes.back().last) == node.first) {
      const std::int64_t wide = node.last - out.nodes.back().first + 1;
      const std::int64_t dense = wide * (wide + 1) / 2 + wide * columns.below(node.last);
      if (!worth_merging(static_cast<int>(wide), dense, own + nonzeros.back())) break;
      node.first = out.nodes.back().first;
      own += nonzeros.back();
      out.nodes.pop_back();
      nonzeros.pop_back();
    }
    out.nodes.push_back(node);
    nonzeros.push_back(own);
  }
  std::vector<int> node_of(out.size);
  for (std::size_t s = 0; s < out.nodes.size(); ++s)
    std::fill(node_of.begin() + out.nodes[s].first, node_of.begin() + out.nodes[s].last + 1, static_cast<int>(s));
  for (Supernode& node : out.nodes) {
    node.first_row = static_cast<std::int64_t>(out.rows.size());
    node.row_count = columns.below(node.last);
    const auto begin = columns.rows.begin() + columns.begin[node.last];
    out.rows.insert(out.rows.end(), begin, begin + node.row_count);
    if (node.row_count > 0) node.parent = node_of[*begin];
  }
}

// Finds a postorder, and how many numbers the stacks of update matrices hold at most while the fronts are eliminated in
// that order.
void find_order(Elimination& out) {
  const int count = static_cast<int>(out.nodes.size());
  std::vector<int> first_child(count, -1), next_sibling(count, -1), pending;
  for (int s = count - 1; s >= 0; --s) {
    const int parent = out.nodes[s].parent;
    if (parent < 0) continue;
    next_sibling[s] = first_child[parent];
    first_child[parent] = s;
  }
  for (int root = 0; root < count; ++root) {
    if (out.nodes[root].parent >= 0) continue;
    pending.push_back(root);
    while (!pending.empty()) {
      const int s = pending.back();
      if (first_child[s] >= 0) {
        pending.push_back(first_child[s]);
        first_child[s] = next_sibling[first_child[s]];
      } else {
        out.order.push_back(s);
        pending.pop_back();
      }
    }
  }
  for (auto s = out.order.rbegin(); s != out.order.rend(); ++s) {
    if (out.nodes[*s].parent >= 0) out.nodes[*s].level = out.nodes[out.nodes[*s].parent].level + 1;
  }
  std::vector<std::int64_t> waiting(count, 0);  // by node: numbers of its children's update matrices
  std::int64_t stacked[2] = {0, 0};
  for (const std::int32_t s : out.order) {
    const Supernode& node = out.nodes[s];
    out.most_column_numbers = std::max(out.most_column_numbers, column_numbers(node.front()));
    const std::int64_t update = update_numbers(node.front());
    std::int64_t& own = stacked[node.level % 2];
    own += update;
    out.deepest_stack[node.level % 2] = std::max(out.deepest_stack[node.level % 2], own);
    stacked[(node.level + 1) % 2] -= waiting[s];
    if (node.parent >= 0) waiting[node.parent] += update;
  }
}

}  // namespace

Elimination Elimination::of(const Eigen::SparseMatrix<double>& matrix) {
  Elimination out;
  out.size = static_cast<int>(matrix.cols());
  find_supernodes(column_patterns(matrix), out);
  find_order(out);
  return out;
}

double Elimination::operations() const {
  double count = 0;
  for (const Supernode& node : nodes) {
    for (double left = node.row_count + node.width(); left > node.row_count; --left) count += left * left;
  }
  return count;
}

}  // namespace supple
