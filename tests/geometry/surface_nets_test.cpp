// Tests the surface around the inside of a field on a grid, and how its quads are cut.
#include "geometry/triangles/surface_nets.h"

#include <gtest/gtest.h>

#include "geometry/solids/surface_pieces.h"
#include "support/surfaces.h"

namespace supple {
namespace surface_nets_test {

const PointGrid small{Vec3(1, 2, 3), 0.5, {5, 5, 5}};

QuadSurface around_the_middle(const PointGrid& grid, float outside) {
  const std::size_t middle = grid.at(2, 2, 2);
  return surface_nets(grid, [&](std::size_t point) { return point == middle ? -1.0f : outside; });
}

TEST(SurfaceNets, OnePointInsideHasACubeAroundItThatIsAsLargeAsTheValuesSay) {
  for (const auto& [outside, half] : {std::pair(1.0f, 0.5 / 6), std::pair(3.0f, 0.25 / 6)}) {
    const QuadSurface surface = around_the_middle(small, outside);
    ASSERT_EQ(surface.points.size(), 8u);
    EXPECT_EQ(surface.quads.size(), 6u);
    for (const Vec3& point : surface.points)
      EXPECT_LT(((point - small.position(2, 2, 2)).cwiseAbs() - Vec3::Constant(half)).norm(), 1e-14);
    const TriMesh mesh = triangles_of(surface, Diagonal::first);
    EXPECT_NEAR(enclosed_volume(mesh), 8 * half * half * half, 1e-13) << "faces outward";
  }
}

TEST(SurfaceNets, NothingInsideHasNoSurface) {
  const QuadSurface surface = surface_nets(small, [](std::size_t) { return 0.0f; });
  EXPECT_TRUE(surface.points.empty());
  EXPECT_TRUE(surface.quads.empty());
}

TEST(SurfaceNets, ABallsSurfaceIsClosedAndOfItsVolume) {
  const PointGrid grid{Vec3::Constant(-1.23), 0.06, {42, 42, 42}};
  std::vector<float> field(grid.size());
  for (int k = 0; k < grid.points.z(); ++k)
    for (int j = 0; j < grid.points.y(); ++j)
      for (int i = 0; i < grid.points.x(); ++i) field[grid.at(i, j, k)] = float(grid.position(i, j, k).norm() - 1);
  const QuadSurface surface = surface_nets(grid, [&](std::size_t point) { return field[point]; });
  EXPECT_EQ(std::ssize(surface.points) - std::ssize(surface.quads), 2) << "Euler's number of a sphere of quads";
  for (const Diagonal diagonal : {Diagonal::first, Diagonal::shorter})
    EXPECT_NEAR(enclosed_volume(triangles_of(surface, diagonal)), 4.18879, 0.03);
}

TEST(SurfaceNets, AQuadIsCutAlongItsFirstOrItsShorterDiagonal) {
  const QuadSurface kite{{Vec3(-2, 0, 0), Vec3(0, -1, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2, 3}}};
  EXPECT_EQ(triangles_of(kite, Diagonal::first).triangles, (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished());
  EXPECT_EQ(triangles_of(kite, Diagonal::shorter).triangles, (Triangles(2, 3) << 0, 1, 3, 1, 2, 3).finished());
  const QuadSurface square{{Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2, 3}}};
  EXPECT_EQ(triangles_of(square, Diagonal::shorter).triangles, triangles_of(square, Diagonal::first).triangles);
}

}  // namespace surface_nets_test
}  // namespace supple
