// Tests the motion between two saved frames.
#include "film/redraw/smooth_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace supple {
namespace smooth_motion_test {

// Returns the places of one vertex that moves along x in four frames.
std::array<Positions, 4> along_x(const std::array<double, 4>& x) {
  std::array<Positions, 4> frames;
  for (std::size_t k = 0; k < 4; ++k) frames[k] = Positions::Zero(1, 3), frames[k](0, 0) = x[k];
  return frames;
}

TEST(SmoothMotion, BeginsAndEndsAtTheFrames) {
  const auto frames = along_x({0, 1, 5, 6});
  EXPECT_EQ(between_frames(frames, 0)(0, 0), 1);
  EXPECT_NEAR(between_frames(frames, 1)(0, 0), 5, 1e-12);
}

TEST(SmoothMotion, FollowsAFreeFallExactly) {
  const auto fall = [](double t) { return 3 * t - 0.5 * 9.81 * t * t; };
  const auto frames = along_x({fall(0.1), fall(0.2), fall(0.3), fall(0.4)});
  for (const double s : {0.25, 0.5, 0.75})
    EXPECT_NEAR(between_frames(frames, s)(0, 0), fall(0.2 + 0.1 * s), 1e-12) << s;
}

TEST(SmoothMotion, FollowsATurnCloserThanAStraightLine) {
  std::array<Positions, 4> frames;
  for (int k = 0; k < 4; ++k) {
    frames[std::size_t(k)] = Positions::Zero(1, 3);
    frames[std::size_t(k)].row(0) = Vec3(std::cos(0.3 * k), std::sin(0.3 * k), 0).transpose();
  }
  const double radius = between_frames(frames, 0.5).row(0).norm();
  EXPECT_NEAR(radius, 1, 0.0005);
  EXPECT_GT(1 - (0.5 * (frames[1] + frames[2])).norm(), 0.01) << "a straight line is shorter";
}

TEST(SmoothMotion, WhatComesToRestDoesNotSwingThrough) {
  const auto frames = along_x({0.2, 0.1, 0, 0});
  for (double s = 0; s <= 1; s += 0.05) {
    EXPECT_GE(between_frames(frames, s)(0, 0), -1e-12) << s;
    EXPECT_LE(between_frames(frames, s)(0, 0), 0.1 + 1e-12) << s;
  }
  EXPECT_EQ(between_frames(along_x({0.1, 0, 0, 0}), 0.5)(0, 0), 0);
}

}  // namespace smooth_motion_test
}  // namespace supple
