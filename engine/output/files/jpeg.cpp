#include "output/files/jpeg.h"

#include <csetjmp>
#include <cstdio>  // before jpeglib.h, which needs it
#include <string>

#include <jpeglib.h>

#include "base/error.h"

namespace supple {
namespace {

struct JpegErrors {
  jpeg_error_mgr manager;  // first, so that the library's pointer to it is one to this struct
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX];
};

// Leaves the library after an error by a jump: the library must not go on, and no exception may pass through its C
// code.
[[noreturn]] void leave(j_common_ptr info) {
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  info->err->format_message(info, errors->message);
  std::longjmp(errors->back, 1);
}

// Compresses a picture. Returns false after an error. bytes: room for `size` bytes, which is enough; `size` becomes the
// number of bytes that are used. No object with a destructor may live in this function, which errors leave by a jump.
bool compress(int width, int height, const std::uint8_t* rgb, int quality, unsigned char* bytes, unsigned long& size,
              JpegErrors& errors) {
  jpeg_compress_struct info{};
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave;
  if (setjmp(errors.back) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&info, TRUE);
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  while (info.next_scanline < info.image_height) {
    JSAMPROW line = const_cast<JSAMPROW>(rgb + row * info.next_scanline);  // which is only read
    jpeg_write_scanlines(&info, &line, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

std::vector<std::uint8_t> jpeg_bytes(int width, int height, const std::vector<std::uint8_t>& rgb, int quality) {
  SUPPLE_CHECK(rgb.size(), ==, 3 * std::size_t(width) * std::size_t(height));
  // A block of 8 x 8 pixels has at most 6 bytes a pixel without subsampling (as TurboJPEG's tjBufSize counts).
  const auto blocks = [](int pixels) { return (static_cast<std::size_t>(pixels) + 15) / 16 * 16; };
  std::vector<std::uint8_t> bytes(6 * blocks(width) * blocks(height) + 2048);
  unsigned long size = bytes.size();
  JpegErrors errors{};
  if (!compress(width, height, rgb.data(), quality, bytes.data(), size, errors))
    throw RunError(std::string("a picture could not be compressed: ") + errors.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace supple
