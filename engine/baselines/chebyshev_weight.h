// Computes the weights of Chebyshev's semi-iterative method (Wang 2015, "A Chebyshev semi-iterative approach for
// accelerating projective and position-based dynamics", algorithm 1).
#pragma once

#include "sim/model/inputs.h"

namespace supple {

// Returns omega of an iteration, counted from 0, from that of the iteration before.
inline double chebyshev_weight(const ChebyshevSettings& settings, int iteration, double before) {
  const double squared = settings.radius * settings.radius;
  if (iteration < settings.delay) return 1;
  return iteration == settings.delay ? 2 / (2 - squared) : 4 / (4 - squared * before);
}

}  // namespace supple
