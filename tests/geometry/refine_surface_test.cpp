// Tests that large triangles are refined without gaps, folds or a change of shape.
#include "geometry/triangles/refine_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "support/surfaces.h"

namespace supple {
namespace refine_surface_test {

Vec3 area(const TriMesh& mesh, Eigen::Index t) {
  const auto corner = [&](int k) -> Vec3 { return mesh.points.row(mesh.triangles(t, k)); };
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

TEST(RefinedSurface, HasShortEdgesAndNoGaps) {
  const TriMesh box = test::box_surface(Vec3(0.5, 2, 0.05));
  const RefinedSurface fine = refined(box, 0.2, 1'000'000);
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index t = 0; t < fine.mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = fine.mesh.triangles(t, k), b = fine.mesh.triangles(t, (k + 1) % 3);
      EXPECT_LE((fine.mesh.points.row(a) - fine.mesh.points.row(b)).norm(), 0.2);
      ++edges[{a, b}];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));  // no vertex lies on a neighbour's edge
  }
  EXPECT_EQ(fine.mesh.points.topRows(8), box.points);
}

TEST(RefinedSurface, CoversEachTriangleWithItsParts) {
  const TriMesh box = test::box_surface(Vec3(0.5, 2, 0.05));
  const RefinedSurface fine = refined(box, 0.2, 1'000'000);
  std::vector<double> covered(12, 0);
  for (Eigen::Index t = 0; t < fine.mesh.triangles.rows(); ++t) {
    const Vec3 whole = area(box, fine.parent[std::size_t(t)]), part = area(fine.mesh, t);
    EXPECT_NEAR(part.dot(whole), part.norm() * whole.norm(), 1e-12);  // in the same plane, on the same side
    covered[std::size_t(fine.parent[std::size_t(t)])] += part.norm();
  }
  for (Eigen::Index t = 0; t < 12; ++t) EXPECT_NEAR(covered[std::size_t(t)], area(box, t).norm(), 1e-12);
}

TEST(RefinedSurface, LeavesSmallTrianglesAloneAndKeepsItsLimit) {
  const TriMesh ball = test::sphere_surface(1, 30, 20);
  const RefinedSurface same = refined(ball, 1, 1'000'000);
  EXPECT_EQ(same.mesh.points, ball.points);
  EXPECT_EQ(same.mesh.triangles, ball.triangles);
  const RefinedSurface some = refined(test::box_surface(Vec3(1, 1, 1)), 1e-6, 5000);
  EXPECT_LE(some.mesh.triangles.rows(), 5000);
  EXPECT_GT(some.mesh.triangles.rows(), 1000);
}

}  // namespace refine_surface_test
}  // namespace supple
