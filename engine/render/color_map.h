// Makes colour maps: sequences of colours along which equal steps of a value look equally large, and whose lightness
// alone tells low from high. Not here: which value has which colour (film/pictures/surface_field.h).
#pragma once

#include <vector>

#include "base/names.h"
#include "base/types.h"

namespace supple {

enum class ColorMap {
  viridis,      // dark violet over green to yellow
  blue_yellow,  // the same lightness without green and red, which some eyes cannot tell apart
  blue_orange,  // from both ends to a light neutral middle, for values around a mean
};
template <>
struct Names<ColorMap> {
  static constexpr std::array table = {Name{ColorMap::viridis, "viridis"}, Name{ColorMap::blue_yellow, "blue-yellow"},
                                       Name{ColorMap::blue_orange, "blue-orange"}};
};

// Returns `count` colours, at least 2, from the low end to the high one [sRGB].
std::vector<Vec3> colors_of(ColorMap map, int count);

// Returns lightness L, from 0 (black) to 1 (white), and the colour's coordinates a and b in OKLab (Ottosson 2020,
// "A perceptual color space for image processing"). srgb: each component from 0 to 1.
Vec3 oklab_of(const Vec3& srgb);
// Returns the sRGB colour of OKLab coordinates; components that no screen shows are cut off at 0 and 1.
Vec3 srgb_of_oklab(const Vec3& lab);

}  // namespace supple
