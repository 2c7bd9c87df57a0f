// Tests how deep meshes are in each other: solids, a solid within another, a cloth, and meshes that cross without a
// vertex inside.
#include "geometry/triangles/shared_depth.h"

#include <gtest/gtest.h>

#include "geometry/meshes/cloth.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {
namespace shared_depth_test {

// A box with its surface, whose lowest corner is at a place.
struct Solid {
  TetMesh mesh;
  Triangles surface;

  Solid(const Vec3& extent, const Eigen::Vector3i& cells, const Vec3& low) : mesh(box_mesh(extent, cells)) {
    mesh.rest.rowwise() += (low - bounds_of(mesh.rest).lower).transpose();
    surface = boundary_faces(mesh.tets);
  }
  PosedMesh posed() const { return {mesh.rest, surface, mesh.tets}; }
};

SharedDepth depth(const PosedMesh& a, const PosedMesh& b) {
  const SharedDepth found = shared_depth(a, b);
  EXPECT_EQ(shared_depth(b, a).depth, found.depth);
  return found;
}

const Vec3 unit(1, 1, 1);
const Eigen::Vector3i four(4, 4, 4);

TEST(SharedDepth, OfCubesIsThatOfTheDeepestVertex) {
  const Solid cube(unit, four, {0, 0, 0});
  for (const double over : {0.3, 0.1, 1e-3, 1e-6}) {
    const Solid above(unit, four, {0, 1 - over, 0});
    EXPECT_NEAR(depth(cube.posed(), above.posed()).depth, over, 1e-12);
  }
  EXPECT_EQ(depth(cube.posed(), Solid(unit, four, {0, 1.1, 0}).posed()).depth, 0);
}

TEST(SharedDepth, OfASmallCubeWithinALargeOneIsToldWithItsPlace) {
  const Solid outer(unit, four, {0, 0, 0}), inner({0.2, 0.2, 0.2}, {1, 1, 1}, {0.3, 0.45, 0.35});
  const SharedDepth found = depth(outer.posed(), inner.posed());
  EXPECT_NEAR(found.depth, 0.45, 1e-12) << "from the outer cube's sides at y = 0 and z = 1";
  EXPECT_NEAR((found.place - Vec3(0.5, 0.45, 0.55)).norm(), 0, 1e-12);
}

TEST(SharedDepth, OfAClothIsThatOfItsVerticesAlone) {
  const ClothMesh cloth = cloth_grid({1, 1}, {4, 4});
  Positions points = cloth.surface.points;
  points.rowwise() += (Vec3(0.5, 0.5, 0.4) - bounds_of(points).center()).transpose();
  const Tetrahedra none(0, 4);
  const Solid cube(unit, four, {0, 0, 0}), small({0.1, 0.1, 0.1}, {2, 2, 2}, {0.55, 0.55, 0.35});
  const PosedMesh sheet{points, cloth.surface.triangles, none};
  EXPECT_NEAR(depth(cube.posed(), sheet).depth, 0.4, 1e-12);
  EXPECT_EQ(depth(small.posed(), sheet).depth, 0) << "it crosses the sheet between its vertices";
  EXPECT_EQ(depth(sheet, sheet).depth, 0);
}

TEST(SharedDepth, OfABarThroughABarIsNone) {
  const Solid along({3, 0.4, 0.4}, {1, 1, 1}, {-1.5, 0, -0.2}), across({0.4, 0.4, 3}, {1, 1, 1}, {-0.2, 0.1, -1.5});
  EXPECT_EQ(depth(along.posed(), across.posed()).depth, 0);
}

}  // namespace shared_depth_test
}  // namespace supple
