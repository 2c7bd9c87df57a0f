// Defines a number that counts the operations made with it, so that the work of a formula that is written for any
// number type can be stated. The count is that of one lane of the vector code: both sides of a choice are computed.
#pragma once

#include <algorithm>
#include <cmath>

namespace supple {

struct Counted {
  double value = 0;

  Counted() = default;
  explicit Counted(double v) : value(v) {}

  // Operations since the caller set it to 0. A sum, product, quotient, comparison, choice or square root counts as one,
  // a fused multiplication and addition as two, and a logarithm or exponential, which are polynomials, as twenty.
  static inline thread_local long operations = 0;

  static Counted made(double v, long cost = 1) {
    operations += cost;
    return Counted(v);
  }
  static bool decided(bool holds) {
    ++operations;
    return holds;
  }

  friend Counted operator+(Counted a, Counted b) { return made(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return made(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return made(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return made(a.value / b.value); }
  friend bool operator<(Counted a, Counted b) { return decided(a.value < b.value); }
  friend bool operator>(Counted a, Counted b) { return decided(a.value > b.value); }
  friend bool operator<=(Counted a, Counted b) { return decided(a.value <= b.value); }
  friend bool operator>=(Counted a, Counted b) { return decided(a.value >= b.value); }
  friend Counted fma(Counted a, Counted b, Counted c) { return made(a.value * b.value + c.value, 2); }
  friend Counted choose(bool condition, Counted yes, Counted no) { return made(condition ? yes.value : no.value); }
  friend Counted max(Counted a, Counted b) { return made(std::max(a.value, b.value)); }
  friend Counted min(Counted a, Counted b) { return made(std::min(a.value, b.value)); }
  friend Counted abs(Counted a) { return made(std::abs(a.value)); }
  friend Counted sqrt(Counted a) { return made(std::sqrt(a.value)); }
  friend Counted log(Counted a) { return made(std::log(a.value), 20); }
  friend Counted log1p(Counted a) { return made(std::log1p(a.value), 20); }
  friend Counted exp(Counted a) { return made(std::exp(a.value), 20); }
};

}  // namespace supple
