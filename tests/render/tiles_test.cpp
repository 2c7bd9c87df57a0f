#include "render/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/view.h"

namespace supple {
namespace tiles_test {

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
      for (int k = 0; k < 3; ++k)
        point[k] = corners[k] + a * (corners[3 + k] - corners[k]) + b * (corners[6 + k] - corners[k]);
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

TEST(Tiles, WideningMarksNeighboursAndNarrowingTakesThemAway) {
  Tiles tiles(width, height), corner(width, height);
  tiles.mark(5, 6);
  corner.mark(0, 0);
  Tiles wide = tiles, wide_corner = corner;
  wide.widen();
  wide_corner.widen();
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int x = 0; x < tiles.columns(); ++x) {
      EXPECT_EQ(wide.marked(x, y), std::abs(x - 5) <= 1 && std::abs(y - 6) <= 1);
      EXPECT_EQ(wide_corner.marked(x, y), x <= 1 && y <= 1);
    }
  }
  wide.narrow();
  wide_corner.narrow();  // tiles beyond the picture count as marked
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int x = 0; x < tiles.columns(); ++x) {
      EXPECT_EQ(wide.marked(x, y), tiles.marked(x, y));
      EXPECT_EQ(wide_corner.marked(x, y), corner.marked(x, y));
    }
  }
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

TEST(Tiles, WhatLiesAroundATriangleOnTheGroundIsMarkedToo) {
  const std::vector<float> triangle = {0.1f, 0, 0.3f, 0.2f, 0, 0.3f, 0.1f, 0, 0.4f};
  Tiles own(width, height), wide(width, height);
  own.mark(triangle, {0, 1, 2}, view());
  constexpr float around = 0.25f;
  wide.mark(triangle, {0, 1, 2}, view(), around);
  int beyond = 0, marked = 0;
  for (int step = 0; step < 64; ++step) {
    const float angle = 0.1f * float(step);
    for (std::size_t corner = 0; corner < 9; corner += 3) {
      const Eigen::Vector4f point(triangle[corner] + around * std::cos(angle), 0,
                                  triangle[corner + 2] + around * std::sin(angle), 1);
      const Eigen::Vector4f clip = view() * point;
      const int x = int((clip.x() / clip.w() + 1) * width / 2) / Tiles::edge,
                y = int((clip.y() / clip.w() + 1) * height / 2) / Tiles::edge;
      EXPECT_TRUE(wide.marked(x, y)) << x << ", " << y;
      beyond += own.marked(x, y) ? 0 : 1;
    }
  }
  EXPECT_GT(beyond, 100);
  for (int y = 0; y < wide.rows(); ++y) {
    for (int x = 0; x < wide.columns(); ++x) marked += wide.marked(x, y) ? 1 : 0;
  }
  // The disc is flat: from a camera 11 degrees above the ground it is some four times as wide as high.
  EXPECT_LT(marked, 80);
}

TEST(Tiles, NarrowingLeavesThoseThatAreSurrounded) {
  Tiles tiles(width, height);
  for (int y = 3; y <= 7; ++y) {
    for (int x = 0; x <= 6; ++x) tiles.mark(x, y);
  }
  const Tiles::Area box = tiles.around();
  EXPECT_EQ(box.left, 0);
  EXPECT_EQ(box.low, 3 * Tiles::edge);
  EXPECT_EQ(box.width, 7 * Tiles::edge);
  EXPECT_EQ(box.height, 5 * Tiles::edge);
  tiles.narrow();
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int x = 0; x < tiles.columns(); ++x)
      EXPECT_EQ(tiles.marked(x, y), y >= 4 && y <= 6 && x <= 5) << x << ", " << y;
  }
  EXPECT_EQ(Tiles(width, height).around().width, 0);
}

TEST(Rays, LeadThroughThePixelsOfTheViewMatrix) {
  const Rays rays = rays_through(camera, width, height);
  for (const Vec3& point : {Vec3(0.3, 0.1, 0.2), Vec3(-1, 0.7, -1), Vec3(0.8, -0.3, 1)}) {
    const Eigen::Vector4f clip = view() * point.homogeneous().cast<float>();
    const double x = (clip.x() / clip.w() + 1) * width / 2, y = (clip.y() / clip.w() + 1) * height / 2;
    const Vec3 ray = rays.corner + x * rays.right + y * rays.up;
    EXPECT_LT(ray.cross(point - camera.eye).norm(), 1e-5 * (point - camera.eye).norm());
    const double along = (point - camera.eye).dot((camera.target - camera.eye).normalized());
    EXPECT_NEAR(clip.w(), along, 1e-5 * along);
  }
}

}  // namespace tiles_test
}  // namespace supple
