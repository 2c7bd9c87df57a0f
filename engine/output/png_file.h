// Reads and writes PNG images. libdeflate writes them at level 1 without row filters: the fastest of the settings tried
// that did not make files larger than zlib does at level 3, and 1.8 times as fast. This is the only place that knows
// libdeflate, and libpng, which reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace supple {

// A file's content: 8-bit RGB, rows from the top. Equal images give equal bytes.
std::vector<std::uint8_t> png_bytes(int width, int height, std::span<const std::uint8_t> rgb);

// Writes 8-bit RGB, rows from the top. The file is written under a temporary name and renamed, so that a file that
// exists is whole. Throws RunError when the disk refuses.
void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb);

struct PngImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// Reads any PNG as 8-bit RGB. Throws InputError when it cannot.
PngImage read_png(const std::filesystem::path& path);

// Tells whether a file begins and ends as a PNG does, without reading what lies between.
bool looks_whole(const std::filesystem::path& png);

}  // namespace supple
