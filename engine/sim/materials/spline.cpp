#include "sim/materials/spline.h"

#include "base/error.h"

namespace supple {
namespace {

// Finds the second derivatives of the natural spline through the points (Press et al. 2007, "Numerical recipes",
// section 3.3): the tridiagonal system is solved by elimination and back substitution.
std::vector<double> second_derivatives(const std::vector<ControlPoint>& p) {
  const std::size_t n = p.size();
  std::vector<double> second(n, 0.0), right(n, 0.0), ratio(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = p[i].at - p[i - 1].at, after = p[i + 1].at - p[i].at;
    const double turn = (p[i + 1].value - p[i].value) / after - (p[i].value - p[i - 1].value) / before;
    const double pivot = 2 * (before + after) - before * ratio[i - 1];
    ratio[i] = after / pivot;
    right[i] = (6 * turn - before * right[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) second[i] = right[i] - ratio[i] * second[i + 1];
  return second;
}

double of_curve(const SplineCurve& curve, double x) {
  double value = 0;
  if (!curve.empty()) curve.beyond_linear(x, value);
  return value;
}

constexpr double sampled_stretches[] = {0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0, 1.1, 1.3, 1.6, 2.0, 2.5};
constexpr double sampled_volumes[] = {0.1, 0.14, 0.2, 0.28, 0.4, 0.6, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5};

// Samples Neo-Hookean curves with `extra` added to a'.
template <class Extra>
Spline sampled(const Lame& lame, const Extra& extra) {
  std::vector<ControlPoint> a, c;
  for (const double s : sampled_stretches) a.push_back({s, lame.mu * (s + extra(s))});
  for (const double j : sampled_volumes) c.push_back({j, (lame.lambda * std::log(j) - lame.mu) / j});
  return {SplineCurve(std::move(a)), {}, SplineCurve(std::move(c))};
}

}  // namespace

SplineCurve::SplineCurve(std::vector<ControlPoint> points) : points_(std::move(points)) {
  SUPPLE_CHECK(points_.size(), >=, 2u);
  const std::size_t n = points_.size();
  const std::vector<double> second = second_derivatives(points_);
  pieces_.resize(n + 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double width = points_[i + 1].at - points_[i].at;
    SUPPLE_CHECK(width, >, 0.0);
    const double rise = (points_[i + 1].value - points_[i].value) / width;
    pieces_[i + 1].c = {points_[i].value, rise - width * (2 * second[i] + second[i + 1]) / 6, second[i] / 2,
                        (second[i + 1] - second[i]) / (6 * width)};
  }
  const double width = points_[n - 1].at - points_[n - 2].at;
  pieces_[0].c = {points_[0].value, pieces_[1].c[1], 0, 0};
  pieces_[n].c = {points_[n - 1].value,
                  (points_[n - 1].value - points_[n - 2].value) / width + width * second[n - 2] / 6, 0, 0};
  double energy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    pieces_[i + 1].from = points_[i].at;
    pieces_[i + 1].energy = energy;
    if (i + 1 < n) energy += pieces_[i + 1].integral(points_[i + 1].at - points_[i].at);
  }
  pieces_[0].from = points_[0].at;
  pieces_[0].energy = 0;
  count_from_rest();
}

// Returns the same polynomial with t counted from another place.
SplineCurve::Piece SplineCurve::Piece::about(double x) const {
  const double t = x - from;
  return {{c[0] + t * (c[1] + t * (c[2] + t * c[3])), c[1] + t * (2 * c[2] + 3 * t * c[3]), c[2] + 3 * t * c[3], c[3]},
          x,
          energy + integral(t)};
}

// Makes the energies those of beyond_linear(), and lets the pieces that reach 1 count from 1.
void SplineCurve::count_from_rest() {
  const std::size_t n = points_.size();
  const auto begin = [&](std::size_t piece) { return piece == 0 ? -HUGE_VAL : points_[piece - 1].at; };
  const auto end = [&](std::size_t piece) { return piece == n ? HUGE_VAL : points_[piece].at; };
  std::size_t with_rest = 0;
  while (end(with_rest) <= 1) ++with_rest;
  const Piece rest = pieces_[with_rest].about(1);
  at_rest_ = rest.c[0];
  for (std::size_t i = 0; i <= n; ++i) {
    if (begin(i) <= 1 && end(i) >= 1) {
      pieces_[i] = pieces_[i].about(1);
      pieces_[i].c[0] = at_rest_;
      pieces_[i].energy = 0;
    } else {
      pieces_[i].energy -= rest.energy + at_rest_ * (pieces_[i].from - 1);
    }
  }
}

Spline Spline::preset_a(const Lame& lame) {
  return sampled(lame, [](double s) { return s < 1 ? -16 * (s - 1) * (s - 1) : 0.0; });
}

Spline Spline::preset_b(const Lame& lame) {
  return sampled(lame, [](double s) { return s > 1 ? 8 * (s - 1) * (s - 1) : 0.0; });
}

const char* Spline::problem() const {
  double largest = 0;
  for (const SplineCurve* curve : {&a, &b, &c}) {
    for (const ControlPoint& point : curve->points()) largest = std::max(largest, std::abs(point.value));
  }
  return !(std::abs(axial_stress(1)) <= 1e-6 * largest)
             ? "the curves leave a stress at rest: a'(1) + 2 b'(1) + c'(1) must be 0 (give a control point at 1)"
             : nullptr;
}

double Spline::axial_stress(double s) const { return of_curve(a, s) + 2 * of_curve(b, s) + of_curve(c, s); }

std::vector<double> Spline::seams() const {
  std::vector<double> all;
  for (const SplineCurve* curve : {&a, &b, &c}) {
    for (const ControlPoint& point : curve->points()) all.push_back(point.at);
  }
  return all;
}

}  // namespace supple
