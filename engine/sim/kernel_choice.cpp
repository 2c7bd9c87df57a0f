#include "sim/kernels.h"

namespace supple {

// The variants that the build has, from the narrowest to the widest.
#ifdef SUPPLE_PORTABLE
#define SUPPLE_VARIANTS(F) F(baseline) F(avx2)
#else
#define SUPPLE_VARIANTS(F) F(native)
#endif

#define SUPPLE_DECLARE(variant) extern const Kernels kernels_##variant;
SUPPLE_VARIANTS(SUPPLE_DECLARE)

namespace {

struct Runnable {
  const Kernels* table[4];
  int count = 0;

  void add(const Kernels& kernels, bool runs) {
    if (runs) table[count++] = &kernels;
  }
};

[[maybe_unused]] bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
constexpr bool runs_native = true, runs_baseline = true;
#define SUPPLE_RUNS_native runs_native
#define SUPPLE_RUNS_baseline runs_baseline
#define SUPPLE_RUNS_avx2 has_avx2()

Runnable find_runnable() {
  Runnable runnable;
#define SUPPLE_ADD(variant) runnable.add(kernels_##variant, SUPPLE_RUNS_##variant);
  SUPPLE_VARIANTS(SUPPLE_ADD)
  return runnable;
}

const Runnable& runnable() {
  static const Runnable found = find_runnable();
  return found;
}

}  // namespace

const Kernels& kernels() { return *runnable().table[runnable().count - 1]; }

const Kernels* const* kernel_variants(int& count) {
  count = runnable().count;
  return runnable().table;
}

}  // namespace supple
