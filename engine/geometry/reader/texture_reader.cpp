#include "geometry/reader/texture_reader.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>
#include <png.h>

// Of stb, only the readers of TGA and BMP are compiled.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#include <stb/stb_image.h>

namespace supple {
namespace {

ReadTexture refused(std::string why) { return {{}, std::move(why), false, false}; }

std::string too_large(std::int64_t width, std::int64_t height) {
  return "has " + std::to_string(width) + " x " + std::to_string(height) +
         " pixels, with which all textures have more than 67 million";
}

ReadTexture read_png(const std::uint8_t* bytes, std::size_t count, std::int64_t most_pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes, count) == 0) return refused("is no PNG that can be read");
  const std::int64_t pixels = std::int64_t(image.width) * std::int64_t(image.height);
  ReadTexture result;
  if (pixels == 0 || pixels > most_pixels) {
    png_image_free(&image);
    return refused(too_large(image.width, image.height));
  }
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(4 * std::size_t(pixels));
  if (png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr) == 0) {
    const std::string why = image.message;
    png_image_free(&image);
    return refused("is a damaged PNG (" + why + ")");
  }
  result.texture.width = int(image.width);
  result.texture.height = int(image.height);
  result.texture.rgb.resize(3 * std::size_t(pixels));
  for (std::size_t p = 0; p < std::size_t(pixels); ++p) {
    std::memcpy(&result.texture.rgb[3 * p], &rgba[4 * p], 3);
    result.transparent |= rgba[4 * p + 3] != 255;
  }
  return result;
}

// libjpeg reports an error by a call that must not return.
struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf back;
};

[[noreturn]] void leave(j_common_ptr jpeg) { std::longjmp(reinterpret_cast<JpegErrors*>(jpeg->err)->back, 1); }

void count_warning(j_common_ptr jpeg, int level) { jpeg->err->num_warnings += level < 0 ? 1 : 0; }

// Decodes rows into `result`. A call of libjpeg may leave this function by a jump to decode(). So no local variable has
// a destructor, and the function is not inlined: a variable of decode() that changed before the jump would have no
// defined value after it.
[[gnu::noinline]] void decode_rows(jpeg_decompress_struct& jpeg, const std::uint8_t* bytes, std::size_t count,
                                   std::int64_t most_pixels, ReadTexture& result) {
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes, static_cast<unsigned long>(count));
  jpeg_read_header(&jpeg, TRUE);
  const std::int64_t pixels = std::int64_t(jpeg.image_width) * std::int64_t(jpeg.image_height);
  if (pixels == 0 || pixels > most_pixels) {
    result.refusal = too_large(jpeg.image_width, jpeg.image_height);
    return;
  }
  if (jpeg.num_components > 3) {
    result.refusal = "is a JPEG with four inks, and only red, green and blue can be read";
    return;
  }
  jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&jpeg);
  result.texture.width = int(jpeg.output_width);
  result.texture.height = int(jpeg.output_height);
  result.texture.rgb.resize(3 * std::size_t(pixels));
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = &result.texture.rgb[3 * std::size_t(jpeg.output_width) * jpeg.output_scanline];
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
}

// Returns false where libjpeg reported an error.
bool decode(jpeg_decompress_struct& jpeg, JpegErrors& errors, const std::uint8_t* bytes, std::size_t count,
            std::int64_t most_pixels, ReadTexture& result) {
  if (setjmp(errors.back) != 0) return false;
  decode_rows(jpeg, bytes, count, most_pixels, result);
  return true;
}

ReadTexture read_jpeg(const std::uint8_t* bytes, std::size_t count, std::int64_t most_pixels) {
  jpeg_decompress_struct jpeg{};
  JpegErrors errors{};
  jpeg.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave;
  errors.manager.emit_message = count_warning;
  ReadTexture result;
  const bool whole = decode(jpeg, errors, bytes, count, most_pixels, result);
  char why[JMSG_LENGTH_MAX] = "";
  if (!whole) (*errors.manager.format_message)(reinterpret_cast<j_common_ptr>(&jpeg), why);
  result.damaged = errors.manager.num_warnings > 0;
  jpeg_destroy_decompress(&jpeg);
  return whole ? result : refused(std::string("is a damaged JPEG (") + why + ")");
}

// Gives the bytes of a picture to stb, which takes what is missing at the end for zeros, or leaves memory as it is.
struct Source {
  const std::uint8_t* bytes;
  std::size_t left;
  int first_request = 0;   // the size of stb's own buffer, which may be filled in part
  bool too_short = false;  // whether more was asked for than there is
};

int give(void* user, char* data, int size) {
  Source& source = *static_cast<Source*>(user);
  if (source.first_request == 0) source.first_request = size;
  const std::size_t count = std::min(source.left, std::size_t(size));
  std::memcpy(data, source.bytes, count);
  source.bytes += count;
  source.left -= count;
  source.too_short |= count == 0 || (count < std::size_t(size) && size != source.first_request);
  return int(count);
}

void skip(void* user, int count) {
  Source& source = *static_cast<Source*>(user);
  const std::size_t passed = std::min(source.left, std::size_t(std::max(0, count)));
  source.too_short |= passed < std::size_t(std::max(0, count));
  source.bytes += passed;
  source.left -= passed;
}

int is_at_end(void* user) { return static_cast<Source*>(user)->left == 0 ? 1 : 0; }

ReadTexture read_by_stb(const std::uint8_t* bytes, std::size_t count, std::int64_t most_pixels,
                        const std::string& kind) {
  const stbi_io_callbacks callbacks{give, skip, is_at_end};
  int width = 0, height = 0, channels = 0;
  Source head{bytes, count}, source{bytes, count};
  if (stbi_info_from_callbacks(&callbacks, &head, &width, &height, &channels) == 0)
    return refused("is no " + kind + " that can be read");
  const std::int64_t pixels = std::int64_t(width) * height;
  if (pixels <= 0 || pixels > most_pixels) return refused(too_large(width, height));
  std::uint8_t* const rgba = stbi_load_from_callbacks(&callbacks, &source, &width, &height, &channels, 4);
  ReadTexture result;
  if (rgba != nullptr && !source.too_short) {
    result.texture.width = width;
    result.texture.height = height;
    result.texture.rgb.resize(3 * std::size_t(pixels));
    for (std::size_t p = 0; p < std::size_t(pixels); ++p) {
      std::memcpy(&result.texture.rgb[3 * p], &rgba[4 * p], 3);
      result.transparent |= rgba[4 * p + 3] != 255;
    }
  } else {
    result = refused("is a damaged " + kind + " (" + (rgba == nullptr ? stbi_failure_reason() : "too short") + ")");
  }
  stbi_image_free(rgba);
  return result;
}

}  // namespace

ReadTexture read_texture(const std::uint8_t* bytes, std::size_t count, std::int64_t most_pixels) {
  constexpr std::uint8_t png[] = {0x89, 'P', 'N', 'G'}, jpeg[] = {0xff, 0xd8, 0xff};
  if (count >= sizeof png && std::memcmp(bytes, png, sizeof png) == 0) return read_png(bytes, count, most_pixels);
  if (count >= sizeof jpeg && std::memcmp(bytes, jpeg, sizeof jpeg) == 0) return read_jpeg(bytes, count, most_pixels);
  if (count >= 2 && bytes[0] == 'B' && bytes[1] == 'M') return read_by_stb(bytes, count, most_pixels, "BMP");
  Source start{bytes, count};
  const stbi_io_callbacks callbacks{give, skip, is_at_end};
  int width = 0, height = 0, channels = 0;  // a TGA begins with no mark, so that its whole head must make sense
  if (stbi_info_from_callbacks(&callbacks, &start, &width, &height, &channels) != 0)
    return read_by_stb(bytes, count, most_pixels, "TGA");
  return refused("is neither PNG, JPEG, TGA nor BMP");
}

}  // namespace supple
