#include "output/png_file.h"

#include <fmt/core.h>
#include <png.h>
#include <fstream>
#include <string_view>

#include <cerrno>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "output/whole_file.h"

namespace supple {
namespace {

void append(png_structp png, png_bytep bytes, png_size_t count) {
  auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  out.insert(out.end(), bytes, bytes + count);
}

void nothing_to_flush(png_structp) {}

[[noreturn]] void fail(png_structp, png_const_charp message) { throw RunError(fmt::format("PNG: {}", message)); }

void ignore(png_structp, png_const_charp) {}

}  // namespace

void write_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb) {
  SUPPLE_CHECK(rgb.size(), ==, std::size_t(width) * height * 3);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(rgb.size() / 2);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png_create_info_struct(png);
  struct Release {
    png_structp* png;
    png_infop* info;
    ~Release() { png_destroy_write_struct(png, info); }
  } release{&png, &info};
  png_set_write_fn(png, &bytes, append, nothing_to_flush);
  png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(png, 3);
  png_set_filter(png, 0, PNG_FILTER_NONE);
  png_write_info(png, info);
  for (int y = 0; y < height; ++y) png_write_row(png, rgb.data() + std::size_t(y) * width * 3);
  png_write_end(png, nullptr);
  write_whole_file(path, bytes);
}

bool looks_whole(const std::filesystem::path& png) {
  constexpr std::string_view begin = "\x89PNG\r\n\x1a\n", end("\0\0\0\0IEND\xae\x42\x60\x82", 12);
  std::ifstream file(png, std::ios::binary);
  char head[begin.size()] = {}, tail[end.size()] = {};
  file.read(head, sizeof head);
  file.seekg(-static_cast<std::streamoff>(sizeof tail), std::ios::end);
  file.read(tail, sizeof tail);
  return file && std::string_view(head, sizeof head) == begin && std::string_view(tail, sizeof tail) == end;
}

PngImage read_png(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) throw InputError(path.string(), image.message);
  image.format = PNG_FORMAT_RGB;
  PngImage result{int(image.width), int(image.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, result.rgb.data(), 0, nullptr))
    throw InputError(path.string(), image.message);
  return result;
}

}  // namespace supple
