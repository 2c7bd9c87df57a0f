#include "base/variants.h"
#include "sim/linear/linear_kernels.h"

namespace supple {

#define SUPPLE_DECLARE(variant) extern const LinearKernels linear_kernels_##variant;
SUPPLE_VARIANTS(SUPPLE_DECLARE)
#undef SUPPLE_DECLARE

const LinearKernels& linear_kernels(int variant) {
#define SUPPLE_ENTRY(variant) &linear_kernels_##variant,
  static constexpr const LinearKernels* table[] = {SUPPLE_VARIANTS(SUPPLE_ENTRY)};
#undef SUPPLE_ENTRY
  return *table[variant];
}

const LinearKernels& linear_kernels() {
  static const LinearKernels& best = linear_kernels(best_variant());
  return best;
}

}  // namespace supple
