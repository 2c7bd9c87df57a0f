#include "sim/air/wind_field.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace supple {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;

// Returns a number from 0 to below 1. The library's distributions may differ from one standard library to another.
double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

// Returns a direction; all are equally likely.
Vec3 random_direction(std::mt19937_64& engine) {
  const double height = 2 * uniform(engine) - 1, angle = full_turn * uniform(engine);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

}  // namespace

WindField::WindField(const Wind& wind) : mean_(wind.velocity), has_gusts_(false), waves_{} {
  constexpr double shortest = 0.2;  // length of the shortest gusts over that of the largest
  const double speed = wind.gusts * wind.velocity.norm();
  if (speed <= 0) return;
  has_gusts_ = true;
  std::mt19937_64 engine(wind.seed);
  double squares = 0;
  for (int i = 0; i < waves; ++i) {
    Wave& wave = waves_[std::size_t(i)];
    const double shrunk = std::pow(shortest, static_cast<double>(i) / (waves - 1)), root = std::cbrt(shrunk);
    const Vec3 along = random_direction(engine);
    wave.number = full_turn / (wind.gust_length * shrunk) * along;
    wave.frequency = full_turn / (wind.gust_period * root * root);
    wave.phase = full_turn * uniform(engine);
    wave.amplitude = root * along.unitOrthogonal();
    wave.amplitude = Eigen::AngleAxisd(full_turn * uniform(engine), along) * wave.amplitude;
    squares += root * root;
  }
  // The mean square over time of a sum of sines with different frequencies is half the sum of their squares.
  for (Wave& wave : waves_) wave.amplitude *= speed * std::sqrt(2 / squares);
}

Vec3 WindField::at(const Vec3& place, double time) const {
  if (!has_gusts_) return mean_;
  Vec3 velocity = mean_;
  for (const Wave& wave : waves_)
    velocity += std::sin(wave.number.dot(place) - wave.frequency * time + wave.phase) * wave.amplitude;
  return velocity;
}

}  // namespace supple
