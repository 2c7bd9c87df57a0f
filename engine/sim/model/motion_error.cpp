#include "sim/model/motion_error.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

double mass_length(const Model& model, const Part& part, const Positions& d) {
  double sum = 0;
  for (int v = part.first_free; v < part.first_free + part.free; ++v) sum += model.mass[v] * d.row(v).squaredNorm();
  return std::sqrt(sum);
}

double mass_distance(const Model& model, const Part& part, const Positions& a, const Positions& b) {
  double sum = 0;
  for (int v = part.first_free; v < part.first_free + part.free; ++v)
    sum += model.mass[v] * (a.row(v) - b.row(v)).squaredNorm();
  return std::sqrt(sum);
}

// Returns how far a part counts as moving in a step from q to x [m sqrt(kg)].
double own_motion(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x) {
  constexpr double least_share = 0.01, least_of_size = 1e-7;
  const double least = least_of_size * part.size * std::sqrt(part.mass);
  return std::max({mass_distance(model, part, x, q), least_share * mass_distance(model, part, y, q), least});
}

// Returns the largest of numbers of the parts; one that is not a number counts as the largest.
template <class NumberOfPart>
double largest_of_parts(const Model& model, const NumberOfPart& number_of) {
  double largest = 0;
  for (const Part& part : model.parts) {
    const double number = number_of(part);
    if (std::isnan(number)) return number;
    largest = std::max(largest, number);
  }
  return largest;
}

double motion_error_of(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x,
                       const Positions& solved) {
  return mass_distance(model, part, x, solved) / own_motion(model, part, q, y, solved);
}

double estimated_of(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x,
                    const Positions& d, double times) {
  return times * mass_length(model, part, d) / own_motion(model, part, q, y, x);
}

}  // namespace

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

double estimated_motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                              const Positions& d, double times) {
  return largest_of_parts(model, [&](const Part& part) { return estimated_of(model, part, q, y, x, d, times); });
}

double way_in_sizes(const Model& model, const Positions& d) {
  return largest_of_parts(
      model, [&](const Part& part) { return mass_length(model, part, d) / (part.size * std::sqrt(part.mass)); });
}

std::vector<double> estimated_motion_errors(const Model& model, const Positions& q, const Positions& y,
                                            const Positions& x, const Positions& d, double times) {
  std::vector<double> errors;
  for (const Part& part : model.parts) errors.push_back(estimated_of(model, part, q, y, x, d, times));
  return errors;
}

}  // namespace supple
