// Names the precisions in which the solver computes what need not be double.
#pragma once

#include "base/names.h"

namespace supple {

enum class Precision { single_precision, double_precision };
template <>
struct Names<Precision> {
  static constexpr std::array table = {Name{Precision::single_precision, "single"},
                                       Name{Precision::double_precision, "double"}};
};

}  // namespace supple
