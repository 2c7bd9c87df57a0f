#include "base/variants.h"
#include "sim/elements/element_kernels.h"

namespace supple {

#define SUPPLE_DECLARE(variant) extern const ElementKernels element_kernels_##variant;
SUPPLE_VARIANTS(SUPPLE_DECLARE)
#undef SUPPLE_DECLARE

const ElementKernels& element_kernels(int variant) {
#define SUPPLE_ENTRY(variant) &element_kernels_##variant,
  static constexpr const ElementKernels* table[] = {SUPPLE_VARIANTS(SUPPLE_ENTRY)};
#undef SUPPLE_ENTRY
  return *table[variant];
}

const ElementKernels& element_kernels() {
  static const ElementKernels& best = element_kernels(best_variant());
  return best;
}

}  // namespace supple
