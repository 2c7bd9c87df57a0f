#include "output/video/film_colors.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace supple {
namespace film_colors_test {

using Color = std::array<double, 3>;

// ITU-R BT.709-6, sections 3.2 to 3.4, with signals from 0 to 1 and eight bits.
Color signals_of(const Color& rgb) {
  const double luma = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  return {16 + 219 * luma, 128 + 224 * (rgb[2] - luma) / 1.8556, 128 + 224 * (rgb[0] - luma) / 1.5748};
}

TEST(FilmColors, AreThoseOfTheStandard) {
  const std::vector<std::array<int, 3>> known = {{0, 0, 0}, {255, 255, 255}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
  const std::vector<std::array<int, 3>> expected = {
      {16, 128, 128}, {235, 128, 128}, {63, 102, 240}, {173, 42, 26}, {32, 240, 118}};
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::vector<std::uint8_t> rgb, planes;
    for (int pixel = 0; pixel < 4; ++pixel)
      for (const int value : known[i]) rgb.push_back(static_cast<std::uint8_t>(value));
    film_planes(2, 2, rgb, planes);
    const auto luma = static_cast<std::uint8_t>(expected[i][0]);
    EXPECT_EQ(planes, (std::vector<std::uint8_t>{luma, luma, luma, luma, static_cast<std::uint8_t>(expected[i][1]),
                                                 static_cast<std::uint8_t>(expected[i][2])}));
  }
}

TEST(FilmColors, WeighThePixelsAroundEachPlaceOfChroma) {
  constexpr int width = 10, height = 6;
  std::mt19937 random(1);
  std::vector<std::uint8_t> rgb(3 * width * height), planes;
  for (std::uint8_t& value : rgb) value = static_cast<std::uint8_t>(random());
  film_planes(width, height, rgb, planes);
  ASSERT_EQ(planes.size(), std::size_t(width * height * 3 / 2));
  const auto pixel = [&](int x, int y) -> Color {
    const std::uint8_t* at = &rgb[3 * std::size_t(width * y + std::max(x, 0))];
    return {at[0] / 255.0, at[1] / 255.0, at[2] / 255.0};
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) EXPECT_NEAR(planes[std::size_t(width * y + x)], signals_of(pixel(x, y))[0], 0.51);
  for (int y = 0; y < height / 2; ++y) {
    for (int x = 0; x < width / 2; ++x) {
      Color mean = {};
      for (int row = 0; row < 2; ++row) {
        for (int off = -1; off <= 1; ++off) {
          const Color one = pixel(2 * x + off, 2 * y + row);
          for (std::size_t k = 0; k < 3; ++k) mean[k] += (off == 0 ? 0.25 : 0.125) * one[k];
        }
      }
      const std::size_t place = std::size_t(width * height + width / 2 * y + x);
      EXPECT_NEAR(planes[place], signals_of(mean)[1], 0.51);
      EXPECT_NEAR(planes[place + width * height / 4], signals_of(mean)[2], 0.51);
    }
  }
}

}  // namespace film_colors_test
}  // namespace supple
