#include "base/variants.h"
#include "baselines/local_kernels.h"

namespace supple {

#define SUPPLE_DECLARE(variant) extern const LocalKernels local_kernels_##variant;
SUPPLE_VARIANTS(SUPPLE_DECLARE)
#undef SUPPLE_DECLARE

const LocalKernels& local_kernels(int variant) {
#define SUPPLE_ENTRY(variant) &local_kernels_##variant,
  static constexpr const LocalKernels* table[] = {SUPPLE_VARIANTS(SUPPLE_ENTRY)};
#undef SUPPLE_ENTRY
  return *table[variant];
}

const LocalKernels& local_kernels() {
  static const LocalKernels& best = local_kernels(best_variant());
  return best;
}

}  // namespace supple
