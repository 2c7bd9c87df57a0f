// What every material says of itself, so that scene files, stiffness fits, kernels and tests pick a new one up without
// being told.
#pragma once

#include <string_view>

namespace supple {

// What a formula is written in; nobody pays for a decomposition that the formula does not use.
enum class Needs {
  gradient,  // F alone: density(F, P)
  stretch,   // S of the polar decomposition F = R S: density(S, dPsi/dS), and P = R dPsi/dS
};

// One number of a material as a scene file gives it.
template <class M>
struct Parameter {
  const char* name;
  const char* unit;
  const char* meaning;
  double M::*value;
  bool may_be_zero;
};

}  // namespace supple
