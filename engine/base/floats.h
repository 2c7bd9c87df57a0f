// Rounds numbers to single precision, for files and pictures.
#pragma once

#include <span>
#include <vector>

#include "base/types.h"

namespace supple {

inline std::vector<float> as_floats(std::span<const double> values) { return {values.begin(), values.end()}; }
// Returns all coordinates, row by row.
inline std::vector<float> as_floats(const Positions& values) {
  return as_floats(std::span<const double>(values.data(), std::size_t(values.size())));
}

}  // namespace supple
