// Tests that the outermost points of a motion bound it, and are few.
#include "base/motion_hull.h"

#include <gtest/gtest.h>

#include <random>

namespace supple {
namespace motion_hull_test {

TEST(MotionHull, ReachesInEveryDirectionAlmostAsFarAsItsPoints) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Positions points(20000, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 on_ball = Vec3(normal(random), normal(random), normal(random)).normalized();
    points.row(i) = on_ball.transpose().cwiseProduct(Eigen::RowVector3d(3, 1, 0.5));
  }
  MotionHull hull;
  hull.include(points);
  const std::vector<Vec3> kept = hull.points();
  EXPECT_LT(kept.size(), 410u);
  for (int sample = 0; sample < 500; ++sample) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    double reach = -1e9;
    for (const Vec3& point : kept) reach = std::max(reach, point.dot(direction));
    EXPECT_GT(reach, (points * direction).maxCoeff() - 0.01 * 6);
  }
  EXPECT_EQ(box_around(kept).upper, Vec3(points.colwise().maxCoeff()));
}

TEST(MotionHull, OfABoxHasItsCornersOnce) {
  Bounds box;
  box.include({-1, 0, 2});
  box.include({1, 3, 5});
  MotionHull hull;
  for (const Vec3& corner : corners_of(box)) hull.include(corner);
  EXPECT_EQ(hull.points().size(), 8u);
  EXPECT_TRUE(corners_of(Bounds()).empty());
  EXPECT_TRUE(MotionHull().points().empty());
}

}  // namespace motion_hull_test
}  // namespace supple
