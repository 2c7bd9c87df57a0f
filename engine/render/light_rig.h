// Describes sets of lamps: the key light that casts the shadow, a fill from the right, a rim from behind, and the sky.
#pragma once

#include "base/types.h"

namespace supple {

struct LightRig {
  Vec3 to_key;  // towards the key light; any length
  // Towards the two lamps that stand at the same place in all sets; of any length.
  static inline const Vec3 to_fill = Vec3(0.95, 0.25, 0.45), to_rim = Vec3(0.35, 0.55, -0.8);
  Vec3 key, fill, rim, sky;           // linear, as they arrive at a surface that faces them
  double key_share;                   // share of the key light in the light on the open ground
  double sky_share;                   // share of the sky in it, which is the rest
  Vec3 ground_tint, background_tint;  // factors on the colours of the stage, linear
};

// Returns the lamps of a studio for clay films: a warm key from the upper left in front, a cool fill.
inline LightRig studio_light() {
  return {
      {-0.55, 1.0, 0.75}, {2.35, 2.20, 1.98}, {0.46, 0.54, 0.66}, {1.15, 1.12, 1.05}, {0.62, 0.66, 0.72}, 0.62, 0.38,
      {1, 1, 1},          {1, 1, 1}};
}

// Returns the lamps of a low sun from the left, with long shadows; the sky is darker, and the fill is blue.
inline LightRig sunset_light() {
  return {{-1.0, 0.8, 0.6},   {2.9, 1.75, 0.95}, {0.34, 0.38, 0.62}, {1.7, 0.95, 0.5}, {0.46, 0.43, 0.52}, 0.66, 0.34,
          {0.86, 0.62, 0.46}, {1.0, 0.62, 0.40}};
}

// Returns the lamps of a grey sky: light from everywhere above, and shadows that are hardly more than contact shade.
inline LightRig overcast_light() {
  return {
      {-0.25, 1.0, 0.3},  {0.62, 0.64, 0.66}, {0.50, 0.53, 0.57}, {0.35, 0.36, 0.38}, {1.12, 1.16, 1.20}, 0.26, 0.74,
      {0.80, 0.83, 0.86}, {0.82, 0.86, 0.90}};
}

// Returns the lamps of a dark stage: a narrow key and a strong rim against a nearly black background.
inline LightRig dark_light() {
  return {{-0.8, 1.0, 0.45},    {1.9, 1.84, 1.72},   {0.09, 0.11, 0.16}, {1.6, 1.65, 1.8}, {0.13, 0.14, 0.17}, 0.8, 0.2,
          {0.055, 0.058, 0.07}, {0.018, 0.02, 0.026}};
}

}  // namespace supple
