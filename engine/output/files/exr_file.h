// Writes pictures of numbers as OpenEXR files, which programs for compositing read. The library may be missing where
// the program is built; then nothing can be written.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace supple {

// Tells whether the program was built with OpenEXR.
bool writes_exr();

// Returns the content of a file of 32-bit floats, which are not rounded (ZIP compression). values: one number for each
// pixel, which becomes the channel Y, or three, which become R, G and B; rows from the top. Equal pictures give equal
// bytes. Throws RunError without OpenEXR.
std::vector<std::uint8_t> exr_bytes(int width, int height, std::span<const float> values);

}  // namespace supple
