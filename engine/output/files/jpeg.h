// Compresses pictures as JPEG, by libjpeg-turbo.
#pragma once

#include <cstdint>
#include <vector>

namespace supple {

// Returns a JPEG file with full resolution of colours. rgb: three bytes a pixel, rows from the top; quality: 1 to 100.
// Throws RunError where the library refuses the picture.
std::vector<std::uint8_t> jpeg_bytes(int width, int height, const std::vector<std::uint8_t>& rgb, int quality);

}  // namespace supple
