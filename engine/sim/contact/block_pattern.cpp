#include "sim/contact/block_pattern.h"

#include <algorithm>
#include <map>

namespace supple {
namespace {

// Lists the neighbours of each group, ascending.
std::vector<std::vector<int>> neighbours_of(const std::vector<GroupKey>& keys) {
  std::map<std::int32_t, std::vector<int>> by_part;
  for (std::size_t g = 0; g < keys.size(); ++g) {
    for (const std::int32_t part : keys[g]) {
      if (part >= 0) by_part[part].push_back(static_cast<int>(g));
    }
  }
  std::vector<std::vector<int>> neighbours(keys.size());
  for (std::size_t g = 0; g < keys.size(); ++g) {
    std::vector<int>& own = neighbours[g];
    for (const std::int32_t part : keys[g]) {
      if (part >= 0) own.insert(own.end(), by_part[part].begin(), by_part[part].end());
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    own.erase(std::find(own.begin(), own.end(), static_cast<int>(g)));
  }
  return neighbours;
}

void merge_into(std::vector<int>& sorted, const std::vector<int>& more) {
  std::vector<int> all;
  all.reserve(sorted.size() + more.size());
  std::set_union(sorted.begin(), sorted.end(), more.begin(), more.end(), std::back_inserter(all));
  sorted.swap(all);
}

void take_out(std::vector<int>& sorted, int group) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), group);
  if (at != sorted.end() && *at == group) sorted.erase(at);
}

}  // namespace

void VertexParts::set(const std::vector<Part>& parts) {
  ends_.clear();
  for (std::size_t p = 0; p + 1 < parts.size(); ++p) ends_.push_back(parts[p].first_free + parts[p].free);
}

std::int32_t VertexParts::of(std::int32_t vertex) const {
  return static_cast<std::int32_t>(std::upper_bound(ends_.begin(), ends_.end(), vertex) - ends_.begin());
}

// The vertices of a stencil ascend, and so do their parts.
GroupKey VertexParts::of(const ContactStencil& stencil) const {
  GroupKey key{-1, -1, -1, -1};
  std::size_t count = 0;
  for (int k = 0; k < stencil.free; ++k) {
    const std::int32_t part = of(stencil.vertex[k]);
    if (count == 0 || key[count - 1] != part) key[count++] = part;
  }
  return key;
}

std::vector<int> elimination_order(const std::vector<GroupKey>& keys, const std::vector<Eigen::Index>& sizes) {
  std::vector<std::vector<int>> neighbours = neighbours_of(keys);
  const auto degree_of = [&](std::size_t group) {
    Eigen::Index sum = 0;
    for (const int other : neighbours[group]) sum += sizes[other];
    return sum;
  };
  std::vector<Eigen::Index> degree(keys.size());
  for (std::size_t g = 0; g < keys.size(); ++g) degree[g] = degree_of(g);
  std::vector<bool> done(keys.size(), false);
  std::vector<int> order;
  while (order.size() < keys.size()) {
    int next = -1;
    for (std::size_t g = 0; g < keys.size(); ++g) {
      if (!done[g] && (next < 0 || degree[g] < degree[next])) next = static_cast<int>(g);
    }
    done[next] = true;
    order.push_back(next);
    const std::vector<int> around = std::move(neighbours[next]);
    for (const int other : around) {
      merge_into(neighbours[other], around);
      take_out(neighbours[other], other);
      take_out(neighbours[other], next);
      degree[other] = degree_of(other);
    }
  }
  return order;
}

// A column has blocks for the later groups with which its own group shares entries, and for those of each earlier
// column whose first block below the diagonal is in its row.
std::vector<std::vector<int>> blocks_below(const std::vector<GroupKey>& keys) {
  std::vector<std::vector<int>> below = neighbours_of(keys);
  for (std::size_t g = 0; g < below.size(); ++g)
    below[g].erase(below[g].begin(), std::upper_bound(below[g].begin(), below[g].end(), static_cast<int>(g)));
  for (std::size_t g = 0; g < below.size(); ++g) {
    if (below[g].empty()) continue;
    const int parent = below[g].front();
    merge_into(below[parent], below[g]);
    take_out(below[parent], parent);
  }
  return below;
}

double factor_operations(const std::vector<GroupKey>& keys, const std::vector<Eigen::Index>& sizes) {
  const std::vector<int> order = elimination_order(keys, sizes);
  std::vector<GroupKey> ordered;
  for (const int group : order) ordered.push_back(keys[group]);
  const std::vector<std::vector<int>> below = blocks_below(ordered);
  double sum = 0;
  for (std::size_t g = 0; g < below.size(); ++g) {
    const auto own = static_cast<double>(sizes[order[g]]);
    double rows = 0;
    for (const int other : below[g]) rows += static_cast<double>(sizes[order[other]]);
    sum += own * own * own / 3 + own * own * rows + own * rows * rows;
  }
  return sum;
}

}  // namespace supple
