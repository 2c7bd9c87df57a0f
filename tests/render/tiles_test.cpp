#include "render/tiles.h"

#include <gtest/gtest.h>

#include <random>

#include "render/view.h"

namespace supple {
namespace {

constexpr int width = 640, height = 360;
const Camera camera = {Vec3(0.4, 0.8, 4), Vec3(0, 0.2, 0), 35};

Eigen::Matrix4f view() { return view_matrix(camera, double(width) / height, Vec3::Zero(), 3); }

TEST(Tiles, EachPlaceWhereATriangleIsSeenLiesInAMarkedTile) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-2, 2), share(0, 1);
  for (int round = 0; round < 40; ++round) {
    Tiles tiles(width, height);
    std::vector<float> corners(9);
    for (float& value : corners) value = place(random);
    tiles.mark(corners, {0, 1, 2}, view());
    for (int sample = 0; sample < 400; ++sample) {
      float a = share(random), b = share(random);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      Eigen::Vector4f point(0, 0, 0, 1);
      for (int k = 0; k < 3; ++k) point[k] = corners[k] + a * (corners[3 + k] - corners[k]) + b * (corners[6 + k] - corners[k]);
      const Eigen::Vector4f clip = view() * point;
      const auto x = int((clip.x() / clip.w() + 1) * width / 2), y = int((clip.y() / clip.w() + 1) * height / 2);
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      ASSERT_TRUE(tiles.marked(x / Tiles::edge, y / Tiles::edge)) << "pixel " << x << ", " << y;
    }
  }
}

TEST(Tiles, TheCornersCoverTheMarkedTilesAndNothingElse) {
  Tiles tiles(width, height);
  tiles.mark({-1, 0, 0, 1, 0.1f, 0, 0, 1, 0}, {0, 1, 2}, view());
  double expected = 0, area = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) expected += tiles.marked(x / Tiles::edge, y / Tiles::edge) ? 1 : 0;
  }
  const std::vector<float>& c = tiles.corners();
  for (std::size_t t = 0; t < c.size(); t += 6)
    area += 0.5 * ((c[t + 2] - c[t]) * (c[t + 5] - c[t + 1]) - (c[t + 4] - c[t]) * (c[t + 3] - c[t + 1]));
  EXPECT_GT(expected, 0);
  EXPECT_LT(expected, 0.9 * width * height);
  EXPECT_NEAR(area * width * height / 4, expected, 1);
}

TEST(Tiles, ThoseOfAnotherSetCanBeTakenAway) {
  Tiles all(width, height), some(width, height);
  all.mark({-1, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, view());
  some.mark({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, view());
  Tiles rest = all;
  rest.unmark(some);
  int taken = 0, left = 0;
  for (int y = 0; y < height / Tiles::edge; ++y) {
    for (int x = 0; x < width / Tiles::edge; ++x) {
      EXPECT_EQ(rest.marked(x, y), all.marked(x, y) && !some.marked(x, y));
      taken += all.marked(x, y) && some.marked(x, y) ? 1 : 0;
      left += rest.marked(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(taken, 0);
  EXPECT_GT(left, 0);
}

TEST(Tiles, ATriangleThatReachesBehindTheCameraMarksThemAll) {
  Tiles tiles(width, height);
  tiles.mark({0, 0, 0, 1, 0, 0, 0, 0, 9}, {0, 1, 2}, view());
  for (int y = 0; y < height; y += Tiles::edge) {
    for (int x = 0; x < width; x += Tiles::edge) EXPECT_TRUE(tiles.marked(x / Tiles::edge, y / Tiles::edge));
  }
}

TEST(Tiles, WideningReachesAsFarAsItSays) {
  Tiles tiles(width, height);
  tiles.mark({0, 0, 0, 0.01f, 0, 0, 0, 0.01f, 0}, {0, 1, 2}, view());
  std::vector<std::pair<int, int>> before;
  for (int y = 0; y < height / Tiles::edge; ++y) {
    for (int x = 0; x < width / Tiles::edge; ++x) {
      if (tiles.marked(x, y)) before.emplace_back(x, y);
    }
  }
  ASSERT_FALSE(before.empty());
  tiles.widen(40);  // pixels: three tiles
  for (const auto& [x, y] : before) {
    EXPECT_TRUE(tiles.marked(x + 3, y));
    EXPECT_TRUE(tiles.marked(x, y - 3));
    EXPECT_FALSE(tiles.marked(x + 5, y));
  }
}

TEST(Rays, LeadThroughThePixelsOfTheViewMatrix) {
  const Rays rays = rays_through(camera, width, height);
  const DepthScale scale = depth_scale(camera, Vec3::Zero(), 3);
  for (const Vec3& point : {Vec3(0.3, 0.1, 0.2), Vec3(-1, 0.7, -1), Vec3(0.8, -0.3, 1)}) {
    const Eigen::Vector4f clip = view() * point.homogeneous().cast<float>();
    const double x = (clip.x() / clip.w() + 1) * width / 2, y = (clip.y() / clip.w() + 1) * height / 2;
    const Vec3 ray = rays.corner + x * rays.right + y * rays.up;
    EXPECT_LT(ray.cross(point - camera.eye).norm(), 1e-5 * (point - camera.eye).norm());
    const double along = (point - camera.eye).dot((camera.target - camera.eye).normalized());
    EXPECT_NEAR(scale.factor / (scale.offset - (0.5 * clip.z() / clip.w() + 0.5)), along, 2e-3 * along);
  }
}

}  // namespace
}  // namespace supple
