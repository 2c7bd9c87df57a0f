// Defines a register of the vector unit, for the hot loops. Only the files that are compiled once for each instruction
// set include this header: everything here has internal linkage, so that nothing compiled for a wide machine can be
// linked into the code for a narrow one.
#pragma once

#include <xsimd/xsimd.hpp>

namespace supple {
namespace {

using Lanes = xsimd::batch<double>;
constexpr int lanes = static_cast<int>(Lanes::size);

// Sums the lanes in their order, so that the order of a sum is the order of the elements.
[[maybe_unused]] double sum_in_order(const Lanes& v) {
  alignas(64) double value[lanes];
  v.store_aligned(value);
  double sum = value[0];
  for (int i = 1; i < lanes; ++i) sum += value[i];
  return sum;
}

}  // namespace
}  // namespace supple
