// Tests the levels of detail of textures, which are made in linear light.
#include "render/texture_buffer.h"

#include <gtest/gtest.h>

#include <random>

#include "render/color.h"

namespace supple {
namespace texture_buffer_test {

Texture noise(int width, int height) {
  Texture texture{"noise", width, height, Wrap::repeat, Wrap::repeat, {}};
  std::mt19937 random(5);
  for (int i = 0; i < 3 * width * height; ++i) texture.rgb.push_back(std::uint8_t(random() % 256));
  return texture;
}

std::array<double, 3> mean_of(const LinearTexture& level) {
  std::array<double, 3> sum = {};
  for (std::size_t i = 0; i < level.texels.size(); ++i)
    if (i % 4 < 3) sum[i % 4] += level.texels[i];
  for (double& value : sum) value /= double(level.width) * level.height;
  return sum;
}

TEST(TextureBuffer, ATextureIsLinearAndBeginsBelow) {
  const Texture texture{"t", 2, 2, Wrap::repeat, Wrap::repeat, {255, 0, 0, 0, 255, 0, 0, 0, 255, 128, 128, 128}};
  const LinearTexture linear = linear_texture(texture);
  const auto grey = std::uint16_t(std::lround(65535 * linear_of(128 / 255.0)));
  EXPECT_EQ(linear.texels, (std::vector<std::uint16_t>{0, 0, 65535, 65535, grey, grey, grey, 65535,  //
                                                       65535, 0, 0, 65535, 0, 65535, 0, 65535}));
}

TEST(TextureBuffer, EachLevelHasTheMeanOfTheFinerOneAlsoWithOddSides) {
  for (const auto& [width, height] : {std::pair{16, 8}, {17, 9}, {31, 5}, {1, 7}, {3, 1}}) {
    LinearTexture level = linear_texture(noise(width, height));
    const std::array<double, 3> whole = mean_of(level);
    while (level.width > 1 || level.height > 1) {
      const LinearTexture coarse = half_as_fine(level);
      EXPECT_EQ(coarse.width, std::max(1, level.width / 2));
      EXPECT_EQ(coarse.height, std::max(1, level.height / 2));
      ASSERT_EQ(coarse.texels.size(), 4u * std::size_t(coarse.width) * std::size_t(coarse.height));
      level = coarse;
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(mean_of(level)[k], whole[k], 5) << width << " x " << height;
    }
  }
}

}  // namespace texture_buffer_test
}  // namespace supple
