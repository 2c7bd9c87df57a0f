// Tests the curvature of triangle surfaces against that of a ball, from its outside and from its inside.
#include "geometry/triangles/mean_curvature.h"

#include <gtest/gtest.h>

#include "geometry/meshes/cloth.h"
#include "support/surfaces.h"

namespace supple {
namespace mean_curvature_test {

TEST(MeanCurvature, IsThatOfABallOnBothSides) {
  TriMesh ball = test::sphere_surface(0.5, 80, 40);
  for (const double sign : {-1.0, 1.0}) {
    const std::vector<double> curvature = mean_curvature(ball.points, ball.triangles);
    for (const double one : curvature) EXPECT_NEAR(one, sign * 2, 0.1);
    ball.triangles.col(1).swap(ball.triangles.col(2));  // seen from the inside, a ball is hollow
  }
}

// A grid's diagonals alternate, so that half its vertices have four neighbours and half eight.
TEST(MeanCurvature, DoesNotDependOnDiagonals) {
  TriMesh cloth = cloth_grid({1, 1}, {20, 20}).surface;
  for (Eigen::Index v = 0; v < cloth.points.rows(); ++v)
    cloth.points(v, 2) = cloth.points(v, 0) * cloth.points(v, 0) / 8;
  const std::vector<double> curvature = mean_curvature(cloth.points, cloth.triangles);
  for (const Eigen::Index v : {10 * 21 + 10, 10 * 21 + 11, 11 * 21 + 10, 7 * 21 + 4}) {
    const double x = cloth.points(v, 0), slope = x / 4;
    EXPECT_NEAR(curvature[std::size_t(v)], 0.5 * 0.25 / std::pow(1 + slope * slope, 1.5), 2e-3);
  }
}

TEST(MeanCurvature, SmoothingSpreadsAValueAndKeepsAnEvenOne) {
  const TriMesh cloth = cloth_grid({1, 1}, {6, 6}).surface;
  std::vector<double> even(std::size_t(cloth.points.rows()), 0.3), peak(even.size(), 0.0);
  peak[24] = 1;
  smooth_values(cloth.triangles, 3, even);
  smooth_values(cloth.triangles, 3, peak);
  for (const double one : even) EXPECT_NEAR(one, 0.3, 1e-12);
  EXPECT_LT(peak[24], 0.5);
  EXPECT_GT(peak[25], 0.02);
}

}  // namespace mean_curvature_test
}  // namespace supple
