// Defines the rules by which a solid flows, as numbers. Not here: the flow that follows from them
// (elements/element_flow.h).
#pragma once

#include <limits>

namespace supple {

// Describes von Mises' plasticity with linear hardening.
struct Plasticity {
  double yield = 0;                                        // stress at which flow begins [Pa]
  double hardening = 0;                                    // what a plastic strain of 1 adds to it [Pa]
  double limit = std::numeric_limits<double>::infinity();  // the plastic strain that ends the flow
};

// Describes a standard linear solid: a share of the stiffness is that of a Maxwell arm, whose stress relaxes.
struct Creep {
  double share = 0;  // of the stiffness, above 0 and below 1
  double time = 0;   // in which the arm's stress falls to 1/e where nothing moves [s]
};

}  // namespace supple
