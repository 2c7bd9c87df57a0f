// Times short pieces of work.
#pragma once

#include <algorithm>

#include "base/timing.h"

namespace supple {

// Returns the least time of several runs; a first one warms the caches and does not count [ms].
template <class Work>
double least_ms(int repeats, const Work& work) {
  double least = 1e300;
  for (int i = 0; i <= repeats; ++i) {
    const Stopwatch watch;
    work();
    if (i > 0) least = std::min(least, watch.elapsed_ms());
  }
  return least;
}

}  // namespace supple
