// Gives the velocity of the wind at a place and a time: the mean, and gusts that are smooth in both. Nothing else
// enters, so that a film has the same wind whatever ran before, and however many threads run. Gusts are a sum of
// travelling waves with random phases (Shinozuka and Deodatis 1991, "Simulation of stochastic processes by spectral
// representation"). Each moves the air across the way in which it travels, so that no air is compressed (Kraichnan
// 1970, "Diffusion by a random velocity field"). From one wave to the next, lengths shrink while speeds fall with their
// cube root and periods with its square, as in turbulence (Kolmogorov 1941). Not here: forces (air_forces.h).
#pragma once

#include <array>

#include "sim/model/air_inputs.h"

namespace supple {

class WindField {
 public:
  explicit WindField(const Wind& wind);

  // Returns the air's velocity [m/s]. place: [m]; time: [s].
  Vec3 at(const Vec3& place, double time) const;

 private:
  struct Wave {
    Vec3 number;       // wave vector [1/m]
    double frequency;  // angular [1/s]
    double phase;
    Vec3 amplitude;  // [m/s]
  };
  static constexpr int waves = 8;

  Vec3 mean_;
  bool has_gusts_;
  std::array<Wave, waves> waves_;
};

}  // namespace supple
