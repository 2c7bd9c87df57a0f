#include "sim/model/motion_error.h"

namespace supple {

double mass_length(const Model& model, const Part& part, const Positions& d) {
  double sum = 0;
  for (int v = part.first_free; v < part.first_free + part.free; ++v) sum += model.mass[v] * d.row(v).squaredNorm();
  return std::sqrt(sum);
}

namespace {

double mass_distance(const Model& model, const Part& part, const Positions& a, const Positions& b) {
  double sum = 0;
  for (int v = part.first_free; v < part.first_free + part.free; ++v)
    sum += model.mass[v] * (a.row(v) - b.row(v)).squaredNorm();
  return std::sqrt(sum);
}

double motion_error_of(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x,
                       const Positions& solved) {
  return mass_distance(model, part, x, solved) / own_motion(model, part, q, y, solved);
}

}  // namespace

double own_motion(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x) {
  constexpr double least_share = 0.01, least_of_size = 1e-7;
  const double least = least_of_size * part.size * std::sqrt(part.mass);
  return std::max({mass_distance(model, part, x, q), least_share * mass_distance(model, part, y, q), least});
}

double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                    const Positions& solved) {
  return largest_of_parts(model, [&](const Part& part) { return motion_error_of(model, part, q, y, x, solved); });
}

std::vector<double> motion_errors(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                                  const Positions& solved) {
  std::vector<double> errors;
  for (const Part& part : model.parts) errors.push_back(motion_error_of(model, part, q, y, x, solved));
  return errors;
}

double way_in_sizes(const Model& model, const Positions& d) {
  return largest_of_parts(
      model, [&](const Part& part) { return mass_length(model, part, d) / (part.size * std::sqrt(part.mass)); });
}

}  // namespace supple
