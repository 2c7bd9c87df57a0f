// Defines the error of motion of a step, which sees whether bodies turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/model/model.h"

namespace supple {

// Returns the error of motion of a step from q to x: how far x is from the solved step x*, over the step's own motion,
// |x - x*|_M / |x* - q|_M, with |d|^2_M the sum of m |d|^2 over the free vertices. It is the largest of the errors of
// the model's parts, so that a fast body does not hide that a slow one is far from where it should be. A body that
// hardly moves has no motion to compare with: it counts as moving by a hundredth of what it would do freely, y - q, and
// by 1e-7 of its size at least. Equation 12 divides by what there is to gain, which a stiff body makes so large that it
// does not see whether the body turns. All n x 3 in the model's order.
double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                    const Positions& solved);
// Returns the error of motion of each of the model's parts.
std::vector<double> motion_errors(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                                  const Positions& solved);
// Returns |d|_M of one part [m sqrt(kg)]. d holds the model's free vertices at least (n_free x 3 [m]).
double mass_length(const Model& model, const Part& part, const Positions& d);
// Returns how far a part counts as moving in a step from q to x [m sqrt(kg)].
double own_motion(const Model& model, const Part& part, const Positions& q, const Positions& y, const Positions& x);

// Returns the largest of numbers of the parts, number_of(part); one that is not a number counts as the largest.
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

// Returns the length of the way d (n_free x 3 [m]) in body sizes, the largest of the model's parts: of each, it is the
// root of the mean of |d|^2 by mass, over the part's size.
double way_in_sizes(const Model& model, const Positions& d);

}  // namespace supple
