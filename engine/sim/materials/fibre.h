// Defines fibres, which a material may have beside its own energy. Not here: what they do in an element
// (elements/tetrahedron.h).
#pragma once

namespace supple {

// Describes fibres along one direction of the rest shape, added to any material: kappa/2 (|F d| - 1)^2 (Liu et al.
// 2017, section 4.4). [J/m^3]
struct Fibre {
  double kappa = 0;                 // [Pa]; 0: none
  double direction[3] = {0, 1, 0};  // unit vector of the rest shape
};

}  // namespace supple
