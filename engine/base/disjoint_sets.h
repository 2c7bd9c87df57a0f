// Keeps which of the numbers 0, 1, 2, ... belong together, while sets of them are joined: the union-find structure of
// Galler and Fischer 1964, with path halving.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace supple {

class DisjointSets {
 public:
  // Every number up to count - 1 is in a set of its own.
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t(0));
  }

  std::size_t size() const { return parent_.size(); }

  // Returns the smallest number of the set that `member` is in.
  std::size_t of(std::size_t member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }

  // Makes one set of the two that these numbers are in.
  void join(std::size_t a, std::size_t b) {
    a = of(a);
    b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace supple
