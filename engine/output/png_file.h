// PNG images. Level 3 without row filters: several times faster than libpng's defaults on rendered frames, and hardly
// larger. The only place that knows libpng.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace supple {

// 8-bit RGB, rows from the top. Written under a temporary name and renamed: a file that exists is whole. Throws
// RunError (the disk).
void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb);

struct PngImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Any PNG as 8-bit RGB. Throws InputError.
PngImage read_png(const std::filesystem::path& path);

// Whether a file begins and ends as a PNG does; what lies between is not read.
bool looks_whole(const std::filesystem::path& png);

}  // namespace supple
