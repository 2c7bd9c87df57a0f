#include "sim/model/motion_error.h"

#include <algorithm>
#include <cmath>

namespace supple {

double mass_length(const Model& model, const Positions& displacement) {
  double sum = 0;
  for (int v = 0; v < model.free; ++v) sum += model.mass[v] * displacement.row(v).squaredNorm();
  return std::sqrt(sum);
}

namespace {

double mass_distance(const Model& model, const Positions& a, const Positions& b) {
  double sum = 0;
  for (int v = 0; v < model.free; ++v) sum += model.mass[v] * (a.row(v) - b.row(v)).squaredNorm();
  return std::sqrt(sum);
}

}  // namespace

double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x, double distance) {
  constexpr double least_share = 0.01, least_of_size = 1e-7;
  const double least = least_of_size * model.size * std::sqrt(model.total_mass);
  return distance / std::max({mass_distance(model, x, q), least_share * mass_distance(model, y, q), least});
}

double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                    const Positions& solved) {
  return motion_error(model, q, y, solved, mass_distance(model, x, solved));
}

}  // namespace supple
