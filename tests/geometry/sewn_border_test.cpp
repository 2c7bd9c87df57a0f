// Tests that border vertices which lie apart become one, pair by pair, and that nothing else is moved.
#include "geometry/triangles/sewn_border.h"

#include <gtest/gtest.h>

#include "geometry/meshes/cloth.h"

namespace supple {
namespace sewn_border_test {

// Puts grids of 4 x 4 cells and 1 m side by side, with a gap between them.
TriMesh grids(int columns, int rows, double gap) {
  TriMesh all;
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) {
      const TriMesh one = cloth_grid({1, 1}, {4, 4}).surface;
      const Eigen::Index before = all.points.rows(), triangles = all.triangles.rows();
      all.points.conservativeResize(before + one.points.rows(), 3);
      all.points.bottomRows(one.points.rows()) =
          one.points.rowwise() + Eigen::RowVector3d(c * (1 + gap), r * (1 + gap), 0);
      all.triangles.conservativeResize(triangles + one.triangles.rows(), 3);
      all.triangles.bottomRows(one.triangles.rows()) = one.triangles.array() + std::int32_t(before);
    }
  }
  return all;
}

TEST(SewnBorder, JoinsThePairsOfASeamInTheirMiddle) {
  const TriMesh surface = grids(2, 1, 0.01);
  const SewnSurface sewn = sewn_border(surface, 0.011);
  EXPECT_EQ(sewn.joined, 5);
  EXPECT_NEAR(sewn.furthest, 0.01, 1e-12);
  EXPECT_EQ(sewn.left, 24);
  EXPECT_EQ(sewn.beside, 0);
  EXPECT_EQ(sewn.mesh.triangles.rows(), surface.triangles.rows());
  EXPECT_EQ(sewn.mesh.points.rows(), 45);
  int on_seam = 0;
  for (const auto& p : sewn.mesh.points.rowwise()) on_seam += std::abs(p.x() - 1.005) < 1e-12 ? 1 : 0;
  EXPECT_EQ(on_seam, 5);
}

TEST(SewnBorder, FourPiecesMeetInOneVertex) {
  const SewnSurface sewn = sewn_border(grids(2, 2, 0.01), 0.015);
  EXPECT_EQ(sewn.mesh.points.rows(), 81);
  EXPECT_EQ(sewn.left, 32);
  int in_the_middle = 0;
  for (const auto& p : sewn.mesh.points.rowwise())
    in_the_middle += (p - Eigen::RowVector3d(1.005, 1.005, 0)).norm() < 1e-9 ? 1 : 0;
  EXPECT_EQ(in_the_middle, 1);
}

TEST(SewnBorder, ADistanceLongerThanEdgesJoinsAcrossTheSeamAlone) {
  const SewnSurface sewn = sewn_border(grids(2, 1, 0.01), 0.3);
  EXPECT_EQ(sewn.joined, 5);
  for (Eigen::Index t = 0; t < sewn.mesh.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) EXPECT_NE(sewn.mesh.triangles(t, k), sewn.mesh.triangles(t, (k + 1) % 3));
}

TEST(SewnBorder, LeavesWhatIsFurtherApartAndCountsWhatLiesBesideAnEdge) {
  const TriMesh surface = grids(2, 1, 0.01);
  const SewnSurface none = sewn_border(surface, 0.009);
  EXPECT_EQ(none.joined, 0);
  EXPECT_EQ(none.mesh.points, surface.points);
  EXPECT_EQ(none.mesh.triangles, surface.triangles);
  // The second piece has twice as many vertices along the seam: every second one finds no partner.
  TriMesh uneven = grids(1, 1, 0);
  const TriMesh fine = cloth_grid({1, 1}, {8, 8}).surface;
  const Eigen::Index before = uneven.points.rows(), triangles = uneven.triangles.rows();
  uneven.points.conservativeResize(before + fine.points.rows(), 3);
  uneven.points.bottomRows(fine.points.rows()) = fine.points.rowwise() + Eigen::RowVector3d(1.01, 0, 0);
  uneven.triangles.conservativeResize(triangles + fine.triangles.rows(), 3);
  uneven.triangles.bottomRows(fine.triangles.rows()) = fine.triangles.array() + std::int32_t(before);
  const SewnSurface slit = sewn_border(uneven, 0.02);
  EXPECT_EQ(slit.joined, 5);
  EXPECT_EQ(slit.beside, 4);
}

}  // namespace sewn_border_test
}  // namespace supple
