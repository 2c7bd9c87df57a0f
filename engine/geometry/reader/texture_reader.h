// Reads PNG, JPEG, TGA and BMP pictures within bounds. A part of supple-read-surface; no other part of the program
// reads JPEG pictures or uses stb.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "base/texture.h"

namespace supple {

struct ReadTexture {
  Texture texture;
  std::string refusal;       // why there is none; empty: there is one
  bool transparent = false;  // whether a pixel lets light through, which the texture does not keep
  bool damaged = false;      // whether a part of it could not be read and is grey
};

// Reads a picture. One of more than `most_pixels` is refused before memory is taken for it.
ReadTexture read_texture(const std::uint8_t* bytes, std::size_t count, std::int64_t most_pixels);

}  // namespace supple
