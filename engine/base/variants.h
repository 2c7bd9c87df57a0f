// Lists the instruction sets that the hot loops are compiled for, from the narrowest to the widest, and tells which of
// them this machine can run. Each table of loops (sim/elements, sim/linear) has one entry for each variant, in this
// order.
#pragma once

#ifdef SUPPLE_PORTABLE
#define SUPPLE_VARIANTS(F) F(baseline) F(avx2)
#else
#define SUPPLE_VARIANTS(F) F(native)
#endif

// Forms the name of a table of loops that is compiled for SUPPLE_VARIANT: SUPPLE_TABLE(linear) is
// linear_kernels_native.
#define SUPPLE_JOINED(kind, variant) kind##_kernels_##variant
#define SUPPLE_NAME(kind, variant) SUPPLE_JOINED(kind, variant)
#define SUPPLE_TABLE(kind) SUPPLE_NAME(kind, SUPPLE_VARIANT)

namespace supple {

// Counts the variants that this machine can run: those with the places 0 to count - 1. There is at least one.
int runnable_variants();

// Returns the variant that is used: the widest one that this machine can run.
inline int best_variant() { return runnable_variants() - 1; }

const char* variant_name(int place);

}  // namespace supple
