// Tests the colour maps: equal steps of a value must look alike, and lightness alone must tell low from high.
#include "render/color_map.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace supple {
namespace color_map_test {

std::vector<Vec3> in_oklab(ColorMap map, int count) {
  std::vector<Vec3> result;
  for (const Vec3& color : colors_of(map, count)) result.push_back(oklab_of(color));
  return result;
}

TEST(ColorMap, OklabHasTheCoordinatesOfItsAuthor) {
  // White, and the sRGB primaries, as Ottosson's page gives them (three digits).
  EXPECT_LT((oklab_of({1, 1, 1}) - Vec3(1, 0, 0)).norm(), 1e-3);
  EXPECT_LT((oklab_of({1, 0, 0}) - Vec3(0.628, 0.225, 0.126)).norm(), 1e-3);
  EXPECT_LT((oklab_of({0, 0, 1}) - Vec3(0.452, -0.032, -0.312)).norm(), 1e-3);
  for (const Vec3& color : {Vec3(0.2, 0.5, 0.9), Vec3(0.9, 0.1, 0.3), Vec3(0.02, 0.02, 0.01)})
    EXPECT_LT((srgb_of_oklab(oklab_of(color)) - color).norm(), 1e-6);
}

TEST(ColorMap, EveryMapIsWithinTheScreensColours) {
  for (const ColorMap map : {ColorMap::viridis, ColorMap::blue_yellow, ColorMap::blue_orange}) {
    for (const Vec3& color : colors_of(map, 64)) {
      EXPECT_GE(color.minCoeff(), 0);
      EXPECT_LE(color.maxCoeff(), 1);
    }
  }
}

TEST(ColorMap, LightnessRisesAlongTheMapsOfASequence) {
  for (const ColorMap map : {ColorMap::viridis, ColorMap::blue_yellow}) {
    const std::vector<Vec3> colors = in_oklab(map, 64);
    for (std::size_t i = 1; i < colors.size(); ++i) EXPECT_GT(colors[i].x(), colors[i - 1].x()) << i;
    EXPECT_GT(colors.back().x() - colors.front().x(), 0.55);
  }
}

TEST(ColorMap, EqualStepsLookAlike) {
  for (const ColorMap map : {ColorMap::viridis, ColorMap::blue_yellow, ColorMap::blue_orange}) {
    const std::vector<Vec3> colors = in_oklab(map, 33);
    double least = 1e9, most = 0;
    for (std::size_t i = 1; i < colors.size(); ++i) {
      least = std::min(least, (colors[i] - colors[i - 1]).norm());
      most = std::max(most, (colors[i] - colors[i - 1]).norm());
    }
    EXPECT_LT(most, 2.2 * least) << name_of(map);
  }
}

TEST(ColorMap, TheMapAroundAMeanIsNeutralThereAndEquallyDarkAtItsEnds) {
  const std::vector<Vec3> colors = in_oklab(ColorMap::blue_orange, 33);
  EXPECT_LT(colors[16].tail<2>().norm(), 0.01);
  EXPECT_NEAR(colors.front().x(), colors.back().x(), 0.02);
  EXPECT_GT(colors[16].x(), colors.front().x() + 0.4);
}

}  // namespace color_map_test
}  // namespace supple
