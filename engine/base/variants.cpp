#include "base/variants.h"

namespace supple {
namespace {

struct Variant {
  const char* name;
  bool (*runs)();
};

[[maybe_unused]] bool runs_baseline() { return true; }
[[maybe_unused]] bool runs_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
[[maybe_unused]] bool runs_native() { return true; }

#define SUPPLE_ENTRY(variant) {#variant, runs_##variant},
constexpr Variant variants[] = {SUPPLE_VARIANTS(SUPPLE_ENTRY)};

}  // namespace

int runnable_variants() {
  int count = 0;
  for (const Variant& variant : variants) {
    if (variant.runs()) ++count;
  }
  return count;
}

const char* variant_name(int place) { return variants[place].name; }

}  // namespace supple
