// Converts sRGB colours to linear light (IEC 61966-2-1).
#pragma once

#include <cmath>

#include "base/types.h"

namespace supple {

inline double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

inline Vec3 linear_of(const Vec3& srgb) { return {linear_of(srgb.x()), linear_of(srgb.y()), linear_of(srgb.z())}; }

// Returns the sRGB colour in which shaders/film.glsl shows linear light: Narkowicz's filmic curve (2015, "ACES filmic
// tone mapping curve"), and the transfer function of sRGB.
inline double film_of(double light, double exposure) {
  const double x = 0.62 * exposure * light;
  const double c = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c < 1 ? c : 1, 1 / 2.4) - 0.055;
}
inline Vec3 film_of(const Vec3& light, double exposure) {
  return {film_of(light.x(), exposure), film_of(light.y(), exposure), film_of(light.z(), exposure)};
}

}  // namespace supple
