// Describes the colours of a surface as a file gives them: by vertex, and as pictures that are laid onto it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace supple {

// Says how a picture goes on beyond its edges.
enum class Wrap : std::int32_t { repeat, clamp, mirror };

struct Texture {
  std::string name;
  int width = 0, height = 0;  // pixels
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  std::vector<std::uint8_t> rgb;  // sRGB, rows from the top
};

// Describes the colour at a vertex, or at a corner of a triangle. It has no padding, so that two of them can be
// compared byte by byte.
struct SurfaceColor {
  float red = 1, green = 1, blue = 1;  // linear; they multiply the texture
  std::int32_t texture = -1;           // number among the surface's textures; -1: none
  float u = 0, v = 0;                  // place in the texture: (0, 0) is its lower left corner, (1, 1) the opposite one
};
static_assert(sizeof(SurfaceColor) == 24);

}  // namespace supple
