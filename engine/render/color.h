// Converts sRGB colours to linear light (IEC 61966-2-1).
#pragma once

#include <cmath>

#include "base/types.h"

namespace supple {

inline double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

inline Vec3 linear_of(const Vec3& srgb) { return {linear_of(srgb.x()), linear_of(srgb.y()), linear_of(srgb.z())}; }

}  // namespace supple
