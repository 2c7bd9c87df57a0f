// Tests which meshes share space: partly, wholly, through edges alone; and that those that touch or are near do not.
#include "geometry/meshes/shared_space.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/meshes/cloth.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {
namespace shared_space_test {

// A mesh with its surface.
struct Solid {
  TetMesh mesh;
  Triangles surface;

  Solid(const Vec3& extent, const Eigen::Vector3i& cells, const Vec3& at) : mesh(box_mesh(extent, cells)) {
    mesh.rest.rowwise() += at.transpose();
    surface = boundary_faces(mesh.tets);
  }
  PosedMesh posed() const { return {mesh.rest, surface, mesh.tets}; }
};

bool share(const Solid& a, const Solid& b) {
  const bool answer = share_space(a.posed(), b.posed());
  EXPECT_EQ(share_space(b.posed(), a.posed()), answer);
  return answer;
}

const Vec3 unit(1, 1, 1);
const Eigen::Vector3i few(3, 3, 3);

TEST(SharedSpace, IsWhatCubesOnOneGridHaveWhereTheyOverlapAndNotWhereTheyTouch) {
  const Solid cube(unit, few, {0.1, 0.2, 0.3});
  for (const double over : {0.9, 2.0 / 3, 0.4, 1e-3, 1e-5})
    EXPECT_TRUE(share(cube, {unit, few, {0.1, 1.2 - over, 0.3}}));
  for (const double gap : {0.0, 1e-12, 1e-9, 1e-5, 0.1}) EXPECT_FALSE(share(cube, {unit, few, {0.1, 1.2 + gap, 0.3}}));
  EXPECT_TRUE(share(cube, cube));
  EXPECT_FALSE(share(cube, {unit, few, {1.1, 1.2, 0.3}})) << "an edge in common";
  EXPECT_FALSE(share(cube, {unit, few, {1.1, 1.2, 1.3}})) << "a corner in common";
  EXPECT_TRUE(share(cube, {unit, {1, 1, 1}, {0.1, 1.1, 0.3}})) << "of a single cell";
}

TEST(SharedSpace, IsWhatABarThroughABarHasWithoutAVertexInside) {
  const Vec3 along_x(3, 0.4, 0.4), along_z(0.4, 0.4, 3);
  const Eigen::Vector3i one_x(1, 1, 1);
  EXPECT_TRUE(share({along_x, one_x, {0, 0, 0}}, {along_z, one_x, {0, 0, 0}}));
  EXPECT_TRUE(share({along_x, one_x, {0, 0.1, 0}}, {along_z, one_x, {0.3, 0, 0}}));
  EXPECT_FALSE(share({along_x, one_x, {0, 0, 0}}, {along_z, one_x, {0, 0.4, 0}}));
  EXPECT_FALSE(share({along_x, one_x, {0, 0, 0}}, {along_z, one_x, {0, 0.401, 0}}));
}

TEST(SharedSpace, IsWhatAMeshWithinAnotherHas) {
  const Solid outer(unit, few, {0, 0, 0});
  EXPECT_TRUE(share(outer, {0.1 * unit, {1, 1, 1}, {0.1, 0.5, 0.1}}));
  EXPECT_TRUE(share(outer, {1.0 / 3 * unit, {1, 1, 1}, {0, 1.0 / 3, 0}})) << "where the other has a cell";
}

// The boxes around bodies that are far from each other may overlap all the same.
TEST(SharedSpace, IsNotWhatBodiesHaveThatAreMerelyNear) {
  Solid turned({2, 0.1, 0.1}, {8, 1, 1}, {0, 0, 0});
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
  turned.mesh.rest = (turned.mesh.rest * turn.transpose()).eval();
  Solid beside = turned;
  beside.mesh.rest.rowwise() += (turn * Vec3(0, 0.101, 0)).transpose();
  EXPECT_FALSE(share(turned, beside));
  beside.mesh.rest.rowwise() -= (turn * Vec3(0, 0.002, 0)).transpose();
  EXPECT_TRUE(share(turned, beside));
}

TEST(SharedSpace, IsWhatAClothHasThatPassesThroughABodyOrAnotherCloth) {
  const ClothMesh cloth = cloth_grid({1, 1}, {4, 4});
  const Tetrahedra none(0, 4);
  const auto at = [&](const Vec3& place) {
    Positions points = cloth.surface.points;
    const Bounds box = bounds_of(points);
    points.rowwise() += (place - box.center()).transpose();
    return points;
  };
  const Positions sheet = at({0, 0.5, 0});
  const PosedMesh posed{sheet, cloth.surface.triangles, none};
  const Solid thin({0.02, 0.02, 3}, {1, 1, 1}, {0.07, 0.53, -1});  // between the vertices of the cloth
  EXPECT_EQ(share_space(posed, thin.posed()), share_space(thin.posed(), posed));
  EXPECT_TRUE(share_space(posed, thin.posed()));
  const Solid wide({3, 3, 3}, {1, 1, 1}, {-1.1, -1.2, -1.3});
  EXPECT_TRUE(share_space(posed, wide.posed())) << "the cloth lies within";
  const Bounds box = bounds_of(sheet);
  const Solid below({3, 1, 3}, {2, 2, 2}, {0, box.lower.y() - 1.001, 0});
  EXPECT_FALSE(share_space(posed, below.posed()));
  Positions across = sheet;
  const Mat3 quarter = Eigen::AngleAxisd(0.5 * 3.14159, Vec3(1, 0.1, 0.2).normalized()).toRotationMatrix();
  across = ((sheet.rowwise() - box.center().transpose()) * quarter.transpose()).rowwise() + box.center().transpose();
  EXPECT_TRUE(share_space(posed, {across, cloth.surface.triangles, none}));
  across.rowwise() += Eigen::RowVector3d(3, 3, 3);
  EXPECT_FALSE(share_space(posed, {across, cloth.surface.triangles, none}));
}

}  // namespace shared_space_test
}  // namespace supple
