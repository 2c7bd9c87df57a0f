// Defines numbers that carry their partial derivatives with respect to three variables (forward automatic
// differentiation: Griewank and Walther 2008, "Evaluating derivatives", chapter 3). A material's formula, written once
// for any number type, gives its second derivatives through them, exact to round-off.
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

template <class V>
struct Dual {
  V value;
  V d[3];

  Dual() : value(0.0), d{V(0.0), V(0.0), V(0.0)} {}
  explicit Dual(double constant) : value(constant), d{V(0.0), V(0.0), V(0.0)} {}
  Dual(const V& v, const V& d0, const V& d1, const V& d2) : value(v), d{d0, d1, d2} {}

  // Returns the variable with the number `which` (0 to 2) at the value v.
  static Dual variable(const V& v, int which) {
    Dual x;
    x.value = v;
    x.d[which] = V(1.0);
    return x;
  }

  // Returns the function of this number whose value here is `at` and whose derivative here is `slope`.
  Dual mapped(const V& at, const V& slope) const { return {at, slope * d[0], slope * d[1], slope * d[2]}; }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.d[0] + b.d[0], a.d[1] + b.d[1], a.d[2] + b.d[2]};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.d[0] - b.d[0], a.d[1] - b.d[1], a.d[2] - b.d[2]};
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, madd(a.value, b.d[0], a.d[0] * b.value), madd(a.value, b.d[1], a.d[1] * b.value),
            madd(a.value, b.d[2], a.d[2] * b.value)};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const V inverse = V(1.0) / b.value, ratio = a.value * inverse;
    return {ratio, (a.d[0] - ratio * b.d[0]) * inverse, (a.d[1] - ratio * b.d[1]) * inverse,
            (a.d[2] - ratio * b.d[2]) * inverse};
  }

  friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend auto operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend auto operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }

  friend Dual madd(const Dual& a, const Dual& b, const Dual& c) { return a * b + c; }

  template <class Condition>
  friend Dual choose(const Condition& condition, const Dual& yes, const Dual& no) {
    return {supple::choose(condition, yes.value, no.value), supple::choose(condition, yes.d[0], no.d[0]),
            supple::choose(condition, yes.d[1], no.d[1]), supple::choose(condition, yes.d[2], no.d[2])};
  }
  friend Dual max(const Dual& a, const Dual& b) { return choose(a.value < b.value, b, a); }
  friend Dual min(const Dual& a, const Dual& b) { return choose(b.value < a.value, b, a); }
  friend Dual abs(const Dual& a) { return choose(a.value < V(0.0), Dual() - a, a); }
  friend Dual log(const Dual& a) {
    using std::log;
    return a.mapped(log(a.value), V(1.0) / a.value);
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const V at = exp(a.value);
    return a.mapped(at, at);
  }
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const V root = sqrt(a.value);
    return a.mapped(root, V(0.5) / root);
  }
};

}  // namespace supple
