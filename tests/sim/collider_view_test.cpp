// Tests which side of a collider holds a vertex that has come into it.
#include "sim/contact/collider_view.h"

#include <gtest/gtest.h>

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

}  // namespace collider_view_test
}  // namespace supple
