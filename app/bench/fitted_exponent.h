// Fits a power law to measurements.
#pragma once

#include <cmath>
#include <limits>
#include <ranges>

namespace supple {

// Returns the exponent p of y ~ x^p: the slope of log y over log x by least squares. Not a number for fewer than two
// rows. x_of, y_of: what gives the two positive numbers of a row.
template <class Rows, class X, class Y>
double fitted_exponent(const Rows& rows, const X& x_of, const Y& y_of) {
  if (std::ranges::size(rows) < 2) return std::numeric_limits<double>::quiet_NaN();
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(std::ranges::size(rows));
  for (const auto& row : rows) {
    const double x = std::log(x_of(row)), y = std::log(y_of(row));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace supple
