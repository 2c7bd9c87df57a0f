#include "output/files/png_file.h"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

void append_number(std::uint32_t number, std::vector<std::uint8_t>& bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(std::uint8_t(number >> shift));
}

// Ends a chunk whose length, name and content begin at `begin`: sets the length and appends the checksum (PNG
// specification, section 5.3).
void end_chunk(std::size_t begin, std::vector<std::uint8_t>& bytes) {
  const std::size_t length = bytes.size() - begin - 8;
  SUPPLE_CHECK(length, <, std::size_t(1) << 31);
  for (int byte = 0; byte < 4; ++byte) bytes[begin + byte] = std::uint8_t(length >> (24 - 8 * byte));
  append_number(libdeflate_crc32(0, bytes.data() + begin + 4, bytes.size() - begin - 4), bytes);
}

// Returns where the chunk begins.
std::size_t begin_chunk(std::string_view name, std::vector<std::uint8_t>& bytes) {
  const std::size_t begin = bytes.size();
  append_number(0, bytes);
  bytes.insert(bytes.end(), name.begin(), name.end());
  return begin;
}

// Puts the number of its filter before each row: 0, which leaves the row as it is (PNG specification, section 9.2).
// Other filters made the files a quarter smaller, but took more time than they saved in compression.
std::vector<std::uint8_t> unfiltered(int width, int height, int channels, std::span<const std::uint8_t> rgb) {
  const std::size_t row_bytes = std::size_t(width) * channels;
  std::vector<std::uint8_t> rows((row_bytes + 1) * height);
  for (int y = 0; y < height; ++y)
    std::copy_n(rgb.data() + y * row_bytes, row_bytes, rows.data() + y * (row_bytes + 1) + 1);
  return rows;
}

void append_compressed(std::span<const std::uint8_t> data, std::vector<std::uint8_t>& bytes) {
  constexpr int level = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (!compressor) throw RunError("PNG: there is no memory to compress with");
  const std::size_t begin = bytes.size();
  bytes.resize(begin + libdeflate_zlib_compress_bound(compressor.get(), data.size()));
  const std::size_t count =
      libdeflate_zlib_compress(compressor.get(), data.data(), data.size(), bytes.data() + begin, bytes.size() - begin);
  SUPPLE_CHECK(count, >, 0u);  // as it is whenever there is room for the bound
  bytes.resize(begin + count);
}

constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n", end_of_file("\0\0\0\0IEND\xae\x42\x60\x82", 12);

}  // namespace

namespace {

std::vector<std::uint8_t> png_of(int width, int height, int channels, std::uint8_t color_type,
                                 std::span<const std::uint8_t> samples) {
  SUPPLE_CHECK(samples.size(), ==, std::size_t(width) * height * channels);
  std::vector<std::uint8_t> bytes(png_signature.begin(), png_signature.end());
  std::size_t chunk = begin_chunk("IHDR", bytes);
  append_number(width, bytes);
  append_number(height, bytes);
  for (const std::uint8_t byte : {std::uint8_t(8), color_type, std::uint8_t(PNG_COMPRESSION_TYPE_DEFAULT),
                                  std::uint8_t(PNG_FILTER_TYPE_DEFAULT), std::uint8_t(PNG_INTERLACE_NONE)})
    bytes.push_back(byte);
  end_chunk(chunk, bytes);
  chunk = begin_chunk("sRGB", bytes);
  bytes.push_back(PNG_sRGB_INTENT_PERCEPTUAL);
  end_chunk(chunk, bytes);
  chunk = begin_chunk("IDAT", bytes);
  append_compressed(unfiltered(width, height, channels, samples), bytes);
  end_chunk(chunk, bytes);
  bytes.insert(bytes.end(), end_of_file.begin(), end_of_file.end());
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> png_bytes(int width, int height, std::span<const std::uint8_t> rgb) {
  return png_of(width, height, 3, PNG_COLOR_TYPE_RGB, rgb);
}

std::vector<std::uint8_t> png_bytes(int width, int height, std::span<const std::uint8_t> rgb,
                                    std::span<const std::uint8_t> alpha) {
  SUPPLE_CHECK(rgb.size(), ==, 3 * alpha.size());
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * alpha.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    rgba.insert(rgba.end(), {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], alpha[i]});
  return png_of(width, height, 4, PNG_COLOR_TYPE_RGB_ALPHA, rgba);
}

void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb) {
  write_whole_file(path, png_bytes(width, height, rgb));
}

bool looks_whole(const std::filesystem::path& png) {
  std::ifstream file(png, std::ios::binary);
  char head[png_signature.size()] = {}, tail[end_of_file.size()] = {};
  file.read(head, sizeof head);
  file.seekg(-static_cast<std::streamoff>(sizeof tail), std::ios::end);
  file.read(tail, sizeof tail);
  return file && std::string_view(head, sizeof head) == png_signature &&
         std::string_view(tail, sizeof tail) == end_of_file;
}

namespace {

// Reads a picture. format: libpng's name for the form of the samples, all of which go into `rgb` of the result, those
// of coverage too.
PngImage read_as(const std::filesystem::path& path, std::uint32_t format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) throw InputError(path.string(), image.message);
  image.format = format;
  PngImage result{int(image.width), int(image.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, result.rgb.data(), 0, nullptr))
    throw InputError(path.string(), image.message);
  return result;
}

}  // namespace

PngImage read_png(const std::filesystem::path& path) { return read_as(path, PNG_FORMAT_RGB); }

PngImage read_png_with_coverage(const std::filesystem::path& path) {
  const PngImage read = read_as(path, PNG_FORMAT_RGBA);
  PngImage result{read.width, read.height, {}, {}};
  for (std::size_t i = 0; i < read.rgb.size(); i += 4) {
    result.rgb.insert(result.rgb.end(), &read.rgb[i], &read.rgb[i] + 3);
    result.alpha.push_back(read.rgb[i + 3]);
  }
  return result;
}

}  // namespace supple
