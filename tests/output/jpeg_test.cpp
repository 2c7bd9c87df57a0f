// Tests that pictures come out of their JPEG as they went in, but for what the eye does not see.
#include <gtest/gtest.h>

#include <cstdio>  // before jpeglib.h, which needs it
#include <cstdlib>

#include <jpeglib.h>

#include "output/files/jpeg.h"

namespace supple {
namespace jpeg_test {

TEST(Jpeg, HoldsThePicture) {
  constexpr int width = 37, height = 21;  // no multiples of its blocks
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      for (const int value : {4 * x + 40, 9 * y + 20, 200 - 3 * x}) rgb.push_back(static_cast<std::uint8_t>(value));
  }
  std::vector<std::uint8_t> bytes = jpeg_bytes(width, height, rgb, 90);
  EXPECT_LT(bytes.size(), rgb.size());

  jpeg_error_mgr errors{};
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  ASSERT_EQ(jpeg_read_header(&info, TRUE), JPEG_HEADER_OK);
  jpeg_start_decompress(&info);
  ASSERT_EQ(int(info.output_width), width);
  ASSERT_EQ(int(info.output_height), height);
  std::vector<std::uint8_t> read(rgb.size());
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = read.data() + std::size_t(3) * width * info.output_scanline;
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  double sum = 0;
  for (std::size_t i = 0; i < rgb.size(); ++i) sum += std::abs(rgb[i] - read[i]);
  EXPECT_LT(sum / double(rgb.size()), 3);
}

}  // namespace jpeg_test
}  // namespace supple
