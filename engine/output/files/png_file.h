// Reads and writes PNG images. libdeflate compresses them at level 1 without row filters: of the settings that were
// tried, the fastest whose files are not larger than those of zlib at level 3, and 1.8 times as fast. No other part of
// the program uses libdeflate, or libpng, which reads the images.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace supple {

// Returns the content of a file with 8-bit RGB, rows from the top. Equal images give equal bytes.
std::vector<std::uint8_t> png_bytes(int width, int height, std::span<const std::uint8_t> rgb);

// Does the same with 8-bit coverage for each pixel, whose colours are not multiplied by it.
std::vector<std::uint8_t> png_bytes(int width, int height, std::span<const std::uint8_t> rgb,
                                    std::span<const std::uint8_t> alpha);

// Writes 8-bit RGB, rows from the top. The file is written under a temporary name and then renamed, so a file that
// exists is complete. Throws RunError when it cannot be written.
void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb);

struct PngImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> alpha = {};  // coverage by pixel, by which the colours are not multiplied; empty: not read
};

// Reads any PNG as 8-bit RGB. Throws InputError when that fails.
PngImage read_png(const std::filesystem::path& path);

// Does the same with coverage, which is whole where the file has none.
PngImage read_png_with_coverage(const std::filesystem::path& path);

// Tells whether a file begins and ends as a PNG does, without reading what lies between.
bool looks_whole(const std::filesystem::path& png);

}  // namespace supple
