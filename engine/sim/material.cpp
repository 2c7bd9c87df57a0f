#include "sim/material.h"

#include <cmath>
#include <numbers>

namespace supple {
namespace {

constexpr int order = 24;  // nodes a panel; the panels end where a material's extension begins

// Nodes and weights on [-1, 1] by Newton on the Legendre polynomial.
struct GaussLegendre {
  double node[order];
  double weight[order];

  GaussLegendre() {
    for (int i = 0; i < order; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (order + 0.5)), slope = 1;
      for (int step = 0; step < 20; ++step) {
        double previous = 1, value = x;
        for (int n = 2; n <= order; ++n) {
          const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
          previous = value;
          value = next;
        }
        slope = order * (x * value - previous) / (x * x - 1);
        x -= value / slope;
      }
      node[i] = x;
      weight[i] = 2 / ((1 - x * x) * slope * slope);
    }
  }
};

}  // namespace

double stiffness(const Material& material, const StretchInterval& interval) {
  static const GaussLegendre rule;
  const auto moment = [&](double from, double to) {
    double sum = 0;
    for (int i = 0; i < order; ++i) {
      const double s = 0.5 * (from + to) + 0.5 * (to - from) * rule.node[i];
      sum += rule.weight[i] * (s - 1) * std::visit([s](const auto& m) { return m.axial_stress(s); }, material);
    }
    return 0.5 * (to - from) * sum;
  };
  const double kink = NeoHookean::smallest_volume_ratio;
  const bool split = interval.start < kink && kink < interval.end;
  const double numerator =
      split ? moment(interval.start, kink) + moment(kink, interval.end) : moment(interval.start, interval.end);
  const double a = interval.start - 1, b = interval.end - 1;
  return numerator / ((b * b * b - a * a * a) / 3);
}

}  // namespace supple
