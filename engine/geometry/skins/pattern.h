// Names the patterns that are printed on bodies.
#pragma once

#include <array>

#include "base/names.h"

namespace supple {

// Names what is printed on a body, in squares of one size, so that its strain can be seen.
enum class Pattern { none, grid, checks };
template <>
struct Names<Pattern> {
  static constexpr std::array table = {Name{Pattern::none, "none"}, Name{Pattern::grid, "grid"},
                                       Name{Pattern::checks, "checks"}};
};

}  // namespace supple
