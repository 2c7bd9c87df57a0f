#include "support/allocation_counter.h"

#include <dlfcn.h>

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> count{0};
}

// Eigen allocates by malloc, and the standard library by operator new, which calls malloc, so one hook sees both.
#if !defined(__SANITIZE_ADDRESS__)
extern "C" {
void* __libc_malloc(std::size_t);
void* malloc(std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
void* __libc_memalign(std::size_t, std::size_t);
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count.fetch_add(1, std::memory_order_relaxed);
  return __libc_memalign(alignment, size);
}
}
#endif

long supple::test::allocations() { return count.load(std::memory_order_relaxed); }
