// Tests the way of a handle that follows a pointer: it is never further from it than the tolerance, and has few keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "live/grabbed_way.h"
#include "scene/definition/keyed_motion.h"

namespace supple {
namespace grabbed_way_test {

constexpr double step = 1.0 / 30;

struct Followed {
  int plans = 0;
  double furthest = 0;  // from the pointer at the end of a frame
};

// Lets a way follow a pointer. pointer: its place at the end of each frame.
Followed follow(GrabbedWay& way, int frames, const std::function<Vec3(double)>& pointer) {
  Followed result;
  KeyedMotion motion;
  motion.ease = Ease::linear;
  for (int frame = 0; frame < frames; ++frame) {
    const double end = (frame + 1) * step;
    if (const auto keys = way.follow(end, step, pointer(end))) {
      motion.keys = *keys;
      ++result.plans;
    }
    result.furthest = std::max(result.furthest, (motion.at(end).translation() - pointer(end)).norm());
  }
  return result;
}

TEST(GrabbedWay, StaysWhereThePointerStays) {
  GrabbedWay way(1e-3, 1);
  const Followed still = follow(way, 100, [](double) { return Vec3(0, 0, 0); });
  EXPECT_EQ(still.plans, 0);
  GrabbedWay moved(1e-3, 1);
  const Followed once = follow(moved, 100, [](double) { return Vec3(0.1, 0, 0); });
  EXPECT_LE(once.plans, 2);
  EXPECT_LE(once.furthest, 1e-3);
}

TEST(GrabbedWay, HasFewKeysOnAStraightWay) {
  GrabbedWay way(1e-3, 1);
  const Followed straight = follow(way, 120, [](double t) { return Vec3(0.3 * t, 0.1 * t, 0); });
  EXPECT_LE(straight.plans, 120 / 4 + 1);
  EXPECT_LE(straight.furthest, 1e-3);
}

TEST(GrabbedWay, IsWithinTheToleranceOnEveryWay) {
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    GrabbedWay way(tolerance, 1);
    const Followed circle =
        follow(way, 200, [](double t) { return Vec3(0.1 * std::sin(4 * t), 0.1 * std::cos(4 * t), 0.01 * t * t); });
    EXPECT_LE(circle.furthest, tolerance);
    EXPECT_LT(circle.plans, tolerance > 5e-3 ? 80 : 201);  // of 200: it leaves the tangent by 1.8 mm in the first frame
  }
}

TEST(GrabbedWay, CoarserTolerancesHaveFewerKeys) {
  const auto pointer = [](double t) { return Vec3(0.1 * std::sin(4 * t), 0, 0); };
  GrabbedWay fine(1e-4, 1), coarse(5e-3, 1);
  EXPECT_LT(2 * follow(coarse, 200, pointer).plans, follow(fine, 200, pointer).plans);
}

TEST(GrabbedWay, GoesNoFurtherInAFrameThanItMayAndComesThereInTheEnd) {
  GrabbedWay way(1e-3, 0.05);
  KeyedMotion motion;
  motion.ease = Ease::linear;
  const Vec3 pointer(1, 0, 0);
  Vec3 before = Vec3::Zero();
  for (int frame = 0; frame < 30; ++frame) {
    const double end = (frame + 1) * step;
    if (const auto keys = way.follow(end, step, pointer)) motion.keys = *keys;
    const Vec3 now = motion.at(end).translation();
    EXPECT_LE((now - before).norm(), 0.05 + 1e-12);
    before = now;
  }
  EXPECT_LE((before - pointer).norm(), 1e-3);
}

}  // namespace grabbed_way_test
}  // namespace supple
