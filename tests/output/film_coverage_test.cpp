// Tests pictures with coverage on their way into films and files.
#include "output/video/film_coverage.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "output/video/film_colors.h"
#include "support/bodies.h"

namespace supple {
namespace film_coverage_test {

TEST(FilmCoverage, ColorsGoOnBeyondABorderAndCoveredPixelsStay) {
  constexpr int width = 23, height = 11;
  std::vector<std::uint8_t> rgb(3 * width * height), alpha(width * height);
  for (int y = 2; y < 8; ++y) {
    for (int x = 3; x < 9; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      alpha[i] = x == 8 ? 40 : 255;
      rgb[3 * i] = 200;
      rgb[3 * i + 1] = static_cast<std::uint8_t>(100 + 5 * y);
    }
  }
  const std::vector<std::uint8_t> filled = filled_colors(width, height, rgb, alpha);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    EXPECT_EQ(filled[3 * i], 200) << i;
    EXPECT_EQ(filled[3 * i + 2], 0) << i;
    EXPECT_GE(filled[3 * i + 1], 110);
    EXPECT_LE(filled[3 * i + 1], 135);
    if (alpha[i] > 0) {
      EXPECT_EQ(filled[3 * i + 1], rgb[3 * i + 1]);
    }
  }
  EXPECT_EQ(filled_colors(2, 1, std::vector<std::uint8_t>(6, 0), std::vector<std::uint8_t>(2, 0)),
            std::vector<std::uint8_t>(6, 0));
}

TEST(FilmCoverage, BlackPixelsAreCoveredInTheSameShareAndOthersFromAHalfOn) {
  constexpr int width = 64;
  const std::vector<std::uint8_t> rgb(3 * width * width, 0), colored(3 * width * width, 7);
  for (const int share : {0, 16, 64, 128, 200, 255}) {
    const std::vector<std::uint8_t> rgba =
        dithered_coverage(width, rgb, std::vector<std::uint8_t>(width * width, static_cast<std::uint8_t>(share)));
    int covered = 0;
    for (std::size_t i = 3; i < rgba.size(); i += 4) covered += rgba[i] == 255 ? 1 : 0;
    EXPECT_NEAR(covered / double(width * width), share / 255.0, 0.5 / 16);
    if (share == 0 || share == 255) {
      EXPECT_EQ(covered, share == 0 ? 0 : width * width);
    }
    const std::vector<std::uint8_t> edge =
        dithered_coverage(width, colored, std::vector<std::uint8_t>(width * width, static_cast<std::uint8_t>(share)));
    for (std::size_t i = 3; i < edge.size(); i += 4) EXPECT_EQ(edge[i], share < 128 ? 0 : 255);
  }
}

TEST(FilmCoverage, FinePlanesHoldEachColorToTheNearestOfTenBits) {
  const std::vector<std::uint8_t> rgb = {255, 255, 255, 0, 0, 0, 255, 0, 0, 12, 200, 77}, alpha = {255, 0, 128, 1};
  std::vector<std::uint8_t> planes;
  fine_film_planes(rgb, alpha, planes);
  ASSERT_EQ(planes.size(), 32U);
  const auto value = [&](std::size_t plane, std::size_t pixel) {
    return planes[8 * plane + 2 * pixel] + 256 * planes[8 * plane + 2 * pixel + 1];
  };
  EXPECT_EQ(value(0, 0), 940);
  EXPECT_EQ(value(0, 1), 64);
  for (std::size_t p = 0; p < 4; ++p) {
    const double r = rgb[3 * p] / 255.0, g = rgb[3 * p + 1] / 255.0, b = rgb[3 * p + 2] / 255.0;
    const double luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    EXPECT_NEAR(value(0, p), 64 + 876 * luma, 0.51);
    EXPECT_NEAR(value(1, p), 512 + 896 * (b - luma) / 1.8556, 0.51);
    EXPECT_NEAR(value(2, p), 512 + 896 * (r - luma) / 1.5748, 0.51);
    EXPECT_NEAR(value(3, p), alpha[p] * 1023 / 255.0, 0.51);
  }
}

TEST(FilmCoverage, IsReadBackFromAPicture) {
  const test::TemporaryFolder folder;
  const std::vector<std::uint8_t> rgb = {1, 2, 3, 250, 251, 252}, alpha = {17, 255};
  write_whole_file(folder.path / "a.png", png_bytes(2, 1, rgb, alpha));
  const PngImage image = read_png_with_coverage(folder.path / "a.png");
  EXPECT_EQ(image.rgb, rgb);
  EXPECT_EQ(image.alpha, alpha);
  write_png(folder.path / "b.png", 2, 1, rgb);
  EXPECT_EQ(read_png_with_coverage(folder.path / "b.png").alpha, (std::vector<std::uint8_t>{255, 255}));
}

}  // namespace film_coverage_test
}  // namespace supple
