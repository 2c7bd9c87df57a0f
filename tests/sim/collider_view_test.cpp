// Tests which side of a collider holds a vertex that has come into it, and ways through the frame of one that turns.
#include "sim/contact/collider_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/contact_scene.h"

namespace supple {
namespace collider_view_test {

// A bar along z, 16 mm wide and high, whose top is at y = 0.008.
struct Bar {
  Collider collider{"bar", test::shape_of(Box{Vec3(0.008, 0.008, 0.5), 0})};
  ColliderMotion motion;
  ColliderTraits traits{collider.shape.certainty(), collider.shape.half_thickness(),
                        collider.shape.usual_half_thickness()};
  ColliderView view{collider, motion, traits};

  // Returns the normal of the side that holds a vertex which went from q to x in a step.
  Vec3 holding(const Vec3& q, const Vec3& x) const {
    QueryMemory near;
    const Way way = view.way(q, x);
    const std::optional<SurfacePoint> held = view.holding(way, view.distance(way.a, near), 0.01, near);
    return held ? held->normal : Vec3::Zero();
  }
};

TEST(ColliderView, AVertexBelongsToTheSideByWhichItCameEvenBesideAnEdge) {
  const Bar bar;
  for (const double high : {0.009, 0.012, 0.05}) {  // ways shorter and longer than the bar is thick
    EXPECT_EQ(bar.holding(Vec3(0, high, 0), Vec3(0, 0.006, 0)), Vec3::UnitY()) << high;
    EXPECT_EQ(bar.holding(Vec3(0.0065, high, 0), Vec3(0.0065, 0.005, 0)), Vec3::UnitY()) << high;
    EXPECT_EQ(bar.holding(Vec3(0.0065, high, 0), Vec3(0.0065, -0.005, 0)), Vec3::UnitY()) << high;
    EXPECT_EQ(bar.holding(Vec3(high, 0.0065, 0), Vec3(0.005, 0.0065, 0)), Vec3::UnitX()) << high;
  }
}

TEST(ColliderView, AVertexThatWasInsideMaySlideAroundAnEdge) {
  const Bar bar;
  const Vec3 behind_top(0.0044, 0.0061, 0);
  EXPECT_EQ(bar.holding(behind_top, Vec3(0.0044, 0.005, 0)), Vec3::UnitY());  // 3 mm below the top, 3.6 from the side
  EXPECT_EQ(bar.holding(behind_top, Vec3(0.006, 0.005, 0)), Vec3::UnitX());   // 3 and 2 mm
}

TEST(ColliderView, AVertexOutsideHasTheClosestSide) {
  const Bar bar;
  EXPECT_EQ(bar.holding(Vec3(0, 0.02, 0), Vec3(0.001, 0.009, 0)), Vec3::UnitY());
  EXPECT_EQ(bar.holding(Vec3(0.02, 0, 0), Vec3(0.009, 0.001, 0)), Vec3::UnitX());
}

// A ball that goes up and turns by 40 degrees in a step.
struct TurningBall {
  Collider collider{"ball", test::shape_of(Sphere{0.1})};
  ColliderMotion motion = turned();
  ColliderTraits traits{collider.shape.certainty(), collider.shape.half_thickness(),
                        collider.shape.usual_half_thickness()};
  ColliderView view{collider, motion, traits};

  static constexpr double angle = 0.7;
  static ColliderMotion turned() {
    ColliderMotion motion;
    motion.start = Eigen::Translation3d(0.2, 0.1, -0.3) * Eigen::AngleAxisd(0.3, Vec3::UnitX());
    motion.end = Eigen::Translation3d(0.2, 0.4, -0.3) * Eigen::AngleAxisd(angle, Vec3(1, 2, 2) / 3) *
                 Eigen::AngleAxisd(0.3, Vec3::UnitX());
    return motion;
  }
};

TEST(ColliderView, WaysThroughATurningFrameArePathsOfItsPoses) {
  const TurningBall ball;
  const Way way = ball.view.way(Vec3(0.5, 0.2, 0.1), Vec3(-0.1, 0.3, 0.4));
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const Vec3 world = way.q + share * (way.x - way.q);
    const Vec3 expected = ball.motion.end.inverse() * (ball.view.motion_after(share) * world);
    EXPECT_LT((ball.view.at(way, share) - expected).norm(), 1e-14) << share;
  }
}

TEST(ColliderView, NoPartOfAWayThroughATurningFrameIsFasterThanItsLengthSays) {
  constexpr int parts = 500;
  const TurningBall ball;
  const std::array<Vec3, 3> places = {Vec3(0.5, 0.2, 0.1), Vec3(-0.1, 0.3, 0.4), Vec3(0.21, 0.3, -0.28)};
  for (const Vec3& q : places) {
    for (const Vec3& x : places) {
      const Way way = ball.view.way(q, x);
      double fastest = 0;
      for (int i = 0; i < parts; ++i) {
        const Vec3 from = ball.view.at(way, double(i) / parts), to = ball.view.at(way, double(i + 1) / parts);
        fastest = std::max(fastest, parts * (to - from).norm());
      }
      EXPECT_LE(fastest, (1 + 1e-9) * way.length);
      EXPECT_GE(fastest, 0.99 * way.length);
    }
  }
}

TEST(ColliderView, WhatTurnsWithAColliderHardlyMovesBesideIt) {
  const TurningBall ball;
  const Vec3 beside(0.3, 0.1, -0.3);
  const Way way = ball.view.way(beside, ball.view.carried(beside));
  EXPECT_LT(way.length, 0.51 * TurningBall::angle * TurningBall::angle * 0.1);  // the chord of the arc is not its path
  EXPECT_GT(way.length, 0);
}

}  // namespace collider_view_test
}  // namespace supple
