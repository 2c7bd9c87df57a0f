// Tests PNG files that we write against libpng, which reads them.
#include "output/files/png_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <string_view>

#include "base/error.h"
#include "support/bodies.h"

namespace supple {
namespace png_test {

std::vector<std::uint8_t> picture(int width, int height, int noise) {
  std::mt19937 dice(7);
  std::vector<std::uint8_t> rgb(std::size_t(width) * height * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i)
    rgb[i] = std::uint8_t(i / 3 + i % 3 * 80 + (noise > 0 ? dice() % noise : 0));
  return rgb;
}

TEST(Png, ComesBackAsItWas) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "a.png";
  for (const auto& [width, height] : {std::pair(1, 1), {1, 7}, {5, 1}, {161, 91}, {320, 180}}) {
    for (const int noise : {0, 3, 256}) {
      const std::vector<std::uint8_t> rgb = picture(width, height, noise);
      write_png(file, width, height, rgb);
      EXPECT_TRUE(looks_whole(file));
      const PngImage back = read_png(file);
      EXPECT_EQ(back.width, width);
      EXPECT_EQ(back.height, height);
      EXPECT_EQ(back.rgb, rgb);
    }
  }
}

TEST(Png, SaysThatItsColoursAreSrgbAndIsTheSameEveryTime) {
  const std::vector<std::uint8_t> rgb = picture(64, 48, 5), bytes = png_bytes(64, 48, rgb);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_NE(text.find("sRGB"), std::string_view::npos);
  EXPECT_EQ(png_bytes(64, 48, rgb), bytes);
}

TEST(Png, ThatIsDamagedIsRefused) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "a.png";
  write_png(file, 64, 48, picture(64, 48, 256));
  std::string bytes = test::read_file(file);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_TRUE(looks_whole(file));
  EXPECT_THROW(read_png(file), InputError);
}

}  // namespace png_test
}  // namespace supple
