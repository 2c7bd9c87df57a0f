// Defines materials designed by curves (Xu, Sin, Zhu, Barbic 2015, "Nonlinear material design using principal
// stretches"): a', b' and c' of the Valanis-Landel form are cubic splines through control points. A curve that is not
// given is zero and costs nothing. The presets A and B are those of the paper's figure 6: Neo-Hookean with more
// resistance to compression, or to tension.
#pragma once

#include <array>
#include <cmath>

#include "sim/materials/log_volume.h"
#include "sim/materials/parameters.h"
#include "sim/materials/valanis_landel.h"

namespace supple {

struct ControlPoint {
  double at;     // stretch, product of two, or volume ratio
  double value;  // derivative of the energy there [Pa]
};

// Represents a natural cubic spline: twice continuously differentiable, and straight beyond its first and last point.
// It is the derivative of an energy that is zero at 1.
class SplineCurve {
 public:
  static constexpr int most_points = 24;

  SplineCurve() = default;
  // Takes at least two points, in ascending order.
  explicit SplineCurve(std::vector<ControlPoint> points);

  bool empty() const { return points_.empty(); }
  const std::vector<ControlPoint>& points() const { return points_; }

  // Returns the curve's value at 1 [Pa].
  double slope_at_rest() const { return at_rest_; }

  // Returns the integral from 1 to x of the curve less its value at 1; `slope` becomes the curve itself.
  template <class V>
  V beyond_linear(const V& x, V& slope) const {
    const Piece& first = pieces_[0];
    Chosen<V> piece{V(first.from), V(first.c[0]), V(first.c[1]), V(first.c[2]), V(first.c[3]), V(first.energy)};
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Piece& next = pieces_[i + 1];
      const auto inside = x >= V(points_[i].at);
      piece = {choose(inside, V(next.from), piece.from), choose(inside, V(next.c[0]), piece.c0),
               choose(inside, V(next.c[1]), piece.c1),   choose(inside, V(next.c[2]), piece.c2),
               choose(inside, V(next.c[3]), piece.c3),   choose(inside, V(next.energy), piece.energy)};
    }
    const V t = x - piece.from;
    const V rise = t * madd(t, madd(t, piece.c3, piece.c2), piece.c1);
    slope = rise + piece.c0;
    const V bend = t * t * madd(t, madd(t, V(0.25) * piece.c3, V(1.0 / 3) * piece.c2), V(0.5) * piece.c1);
    return madd(t, piece.c0 - V(at_rest_), bend + piece.energy);
  }

 private:
  // Holds one piece of the curve, c0 + c1 t + c2 t^2 + c3 t^3 with t = x - from, and the integral beyond_linear() at
  // `from`. The first piece lies before the first point. In pieces that reach 1, `from` is 1, so that nothing cancels.
  struct Piece {
    std::array<double, 4> c;
    double from, energy;

    double integral(double t) const { return t * (c[0] + t * (c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4))); }
    Piece about(double x) const;
  };
  template <class V>
  struct Chosen {
    V from, c0, c1, c2, c3, energy;
  };
  void count_from_rest();

  double at_rest_ = 0;
  std::vector<ControlPoint> points_;
  std::vector<Piece> pieces_;  // points + 1
};

template <class M>
struct Curve {
  const char* name;
  const char* meaning;
  SplineCurve M::*value;
};

struct Spline {
  static constexpr std::string_view name = "spline";
  static constexpr Needs needs = Needs::singular_values;
  SplineCurve a, b, c;

  static constexpr std::array<Parameter<Spline>, 0> parameters() { return {}; }
  static constexpr auto curves() {
    return std::array{
        Curve<Spline>{"a", "control points [stretch, a'] of the curve over a stretch", &Spline::a},
        Curve<Spline>{"b", "control points [product, b'] of the curve over products of two stretches", &Spline::b},
        Curve<Spline>{"c", "control points [J, c'] of the curve over the volume ratio", &Spline::c}};
  }
  // These are the presets, sampled at control points.
  static Spline preset_a(const Lame& lame);
  static Spline preset_b(const Lame& lame);
  const char* problem() const;
  bool energy_may_be_negative() const { return true; }  // nobody knows what will be drawn

  template <class V>
  V density(const V (&s)[3], V (&slope)[3]) const {
    // Absent curves are dispatched outside of the lanes, so that they are not evaluated.
    const NoTerm none;
    if (b.empty() && c.empty()) return valanis_landel(a, none, none, s, slope);
    if (b.empty()) return valanis_landel(a, none, c, s, slope);
    if (c.empty()) return valanis_landel(a, b, none, s, slope);
    return valanis_landel(a, b, c, s, slope);
  }

  double axial_stress(double s) const;
  std::vector<double> seams() const;
};

}  // namespace supple
