// Tells where a budget of time ended the iterations of a step.
#pragma once

#include <array>

namespace supple {

// Holds after how many iterations a budget ended each search of a step: the search from the first iterate, and the one
// from where the body was, which few steps make. -1: the budget did not end that search, or the step did not make it.
struct BudgetCuts {
  std::array<int, 2> after = {-1, -1};

  bool operator==(const BudgetCuts&) const = default;
};

}  // namespace supple
