#include "sim/air/gas_law.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr double least_share = 0.05;  // of the rest volume

// Returns log(1 + z) - z, by a series where z is small and the difference would lose its digits.
double log_beyond_slope(double z) {
  if (std::abs(z) > 0.01) return std::log1p(z) - z;
  double sum = 0;
  for (int k = 8; k >= 2; --k) sum = (k % 2 == 0 ? -1.0 : 1.0) / k + z * sum;
  return z * z * sum;
}

}  // namespace

GasLaw::GasLaw(const GasFilling& filling, double rest_volume)
    : filled_(filling.amount == GasAmount::fixed ? (filling.gauge + atmospheric_pressure) * rest_volume : 0),
      gauge_(filling.gauge),
      rest_(rest_volume),
      least_(least_share * rest_volume) {}

double GasLaw::energy(double volume) const {
  if (filled_ == 0) return -gauge_ * (volume - rest_);
  const double from = std::max(volume, least_), below = volume - from;
  const double of_log = -std::log(from / rest_) - below / from + 0.5 * below * below / (from * from);
  return filled_ * of_log + atmospheric_pressure * (volume - rest_);
}

double GasLaw::gauge_pressure(double volume) const {
  if (filled_ == 0) return gauge_;
  const double from = std::max(volume, least_), below = volume - from;
  return filled_ * (1 / from - below / (from * from)) - atmospheric_pressure;
}

double GasLaw::stiffness(double volume) const {
  const double from = std::max(volume, least_);
  return filled_ / (from * from);
}

double GasLaw::energy_change(double volume, double change) const {
  if (filled_ == 0) return -gauge_ * change;
  if (std::min(volume, volume + change) < least_) return energy(volume + change) - energy(volume);
  const double z = change / volume;
  return -filled_ * log_beyond_slope(z) - gauge_pressure(volume) * change;
}

}  // namespace supple
