#include "sim/materials/material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

constexpr int nodes_a_panel = 24;

// Finds the nodes and weights on [-1, 1] by Newton's method on the Legendre polynomial.
struct GaussLegendre {
  double node[nodes_a_panel];
  double weight[nodes_a_panel];

  GaussLegendre() {
    for (int i = 0; i < nodes_a_panel; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (nodes_a_panel + 0.5)), slope = 1;
      for (int step = 0; step < 20; ++step) {
        double previous = 1, value = x;
        for (int n = 2; n <= nodes_a_panel; ++n) {
          const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
          previous = value;
          value = next;
        }
        slope = nodes_a_panel * (x * value - previous) / (x * x - 1);
        x -= value / slope;
      }
      node[i] = x;
      weight[i] = 2 / ((1 - x * x) * slope * slope);
    }
  }
};

// Returns the ends of the quadrature's panels: the seams of the stress, so that each panel is smooth, and the
// interval's end.
std::vector<double> panel_ends(const Material& material, const StretchInterval& interval) {
  std::vector<double> ends = std::visit(
      [](const auto& m) -> std::vector<double> {
        if constexpr (requires { m.seams(); }) return m.seams();
        return {};
      },
      material);
  std::erase_if(ends, [&](double s) { return s <= interval.start || s >= interval.end; });
  ends.push_back(interval.end);
  std::sort(ends.begin(), ends.end());
  return ends;
}

}  // namespace

std::string_view name_of(const Material& material) {
  return std::visit([](const auto& m) { return m.name; }, material);
}

bool energy_may_be_negative(const Material& material) {
  return std::visit(
      [](const auto& m) {
        if constexpr (requires { m.energy_may_be_negative(); }) return m.energy_may_be_negative();
        return false;
      },
      material);
}

bool has_slack(const Material& material) {
  constexpr double near = 1e-3;
  return std::visit([](const auto& m) { return m.axial_stress(1 - near) == 0 && m.axial_stress(1 + near) == 0; },
                    material);
}

double fitted_stiffness(const Material& material, const StretchInterval& interval) {
  static const GaussLegendre rule;
  const auto stress = [&](double s) { return std::visit([s](const auto& m) { return m.axial_stress(s); }, material); };
  double numerator = 0, from = interval.start;
  for (const double to : panel_ends(material, interval)) {
    double sum = 0;
    for (int i = 0; i < nodes_a_panel; ++i) {
      const double s = 0.5 * (from + to) + 0.5 * (to - from) * rule.node[i];
      sum += rule.weight[i] * (s - 1) * stress(s);
    }
    numerator += 0.5 * (to - from) * sum;
    from = to;
  }
  const double a = interval.start - 1, b = interval.end - 1;
  return numerator / ((b * b * b - a * a * a) / 3);
}

SystemStiffness system_stiffness(const Material& material, const StretchInterval& interval) {
  const auto demanded = std::visit(
      [](const auto& m) -> std::optional<double> {
        if constexpr (requires { m.system_stiffness(); }) return m.system_stiffness();
        return std::nullopt;
      },
      material);
  if (demanded) return {*demanded, false};
  constexpr double floor = 1e-3;  // least k, over the steepest secant of f through rest
  constexpr int samples = 32;
  double steepest = 0;
  for (int i = 0; i <= samples; ++i) {
    const double s = interval.start + (interval.end - interval.start) * i / samples;
    if (std::abs(s - 1) < 1e-9) continue;
    const double f = std::visit([s](const auto& m) { return m.axial_stress(s); }, material);
    steepest = std::max(steepest, std::abs(f / (s - 1)));
  }
  const double fit = fitted_stiffness(material, interval);
  return fit < floor * steepest ? SystemStiffness{floor * steepest, true} : SystemStiffness{fit, false};
}

}  // namespace supple
