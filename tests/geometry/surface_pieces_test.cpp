// Tests which parts of a surface make one piece, and how thick solids are.
#include "geometry/solids/surface_pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/triangles/surface_thickness.h"
#include "support/surfaces.h"

namespace supple {
namespace surface_pieces_test {

TriMesh box_at(double x, double half) { return test::moved(test::box_surface(Vec3(half, half, half)), Vec3(x, 0, 0)); }

std::size_t count_of(const TriMesh& mesh, Joining joining, double gap) {
  return pieces_of({mesh, {}}, joining, gap).pieces.size();
}

TEST(SurfacePieces, WhatOverlapsOrIsNearIsOnePiece) {
  const TriMesh overlap = test::together(box_at(0, 1), box_at(1.5, 1));
  const TriMesh apart = test::together(box_at(0, 1), box_at(2.1, 1));
  EXPECT_EQ(count_of(overlap, Joining::near, 0), 1u);
  EXPECT_EQ(count_of(overlap, Joining::cavities, 0), 2u);
  EXPECT_EQ(count_of(apart, Joining::near, 0.05), 2u);
  EXPECT_EQ(count_of(apart, Joining::near, 0.2), 1u);
  EXPECT_FALSE(pieces_of({overlap, {}}, Joining::near, 0.2).touching);
  EXPECT_TRUE(pieces_of({apart, {}}, Joining::near, 0.2).touching);
}

TEST(SurfacePieces, BarsThatCrossWithoutAVertexInsideOneAnotherOverlap) {
  const TriMesh along = test::box_surface(Vec3(3, 0.2, 0.2)), up = test::box_surface(Vec3(0.1, 3, 0.1));
  EXPECT_EQ(count_of(test::together(along, up), Joining::near, 0), 1u);
}

TEST(SurfacePieces, ACavityBelongsToWhatIsAroundIt) {
  const TriMesh shell = test::together(box_at(0, 1), test::inside_out(box_at(0, 0.5)));
  EXPECT_EQ(count_of(shell, Joining::near, 0), 1u);
  EXPECT_EQ(count_of(shell, Joining::cavities, 0), 1u);
  EXPECT_NEAR(pieces_of({shell, {}}, Joining::near, 0).volumes[0], 8 - 1, 1e-12);
}

TEST(SurfacePieces, WhatIsInsideTwiceCountsOnce) {
  const auto volume = [](const TriMesh& mesh) { return pieces_of({mesh, {}}, Joining::near, 0).volumes[0]; };
  const TriMesh nested = test::together(box_at(0, 0.5), box_at(0.03, 0.3));
  EXPECT_NEAR(volume(nested), 1, 1e-9);
  EXPECT_NEAR(volume(test::together(nested, box_at(0, 0.1))), 1, 1e-9);
  // Half of the smaller box is in the larger one.
  EXPECT_NEAR(volume(test::together(box_at(0, 0.5), box_at(0.5, 0.25))), 1 + 0.125 / 2, 0.005);
  const TriMesh ball = test::sphere_surface(1, 60, 30);
  const double own = enclosed_volume(ball), cap = std::numbers::pi * 0.25 * 2.5 / 3;  // of height 1/2
  EXPECT_NEAR(volume(test::together(ball, test::moved(ball, Vec3(0, 0.3, 1)))), 2 * own - 2 * cap, 0.15);
  const TriMesh shell = test::together(box_at(0, 1), test::inside_out(box_at(0, 0.5)));
  EXPECT_NEAR(volume(test::together(shell, box_at(0.9, 0.2))), 8 - 1 + 0.4 * 0.4 * 0.1, 0.02);
}

TEST(SurfacePieces, TheLargestComesFirstAndWhatIsDrawnGoesWithItsPiece) {
  const TriMesh both = test::together(box_at(0, 0.5), box_at(5, 1));
  const SurfacePieces found = pieces_of({both, both}, Joining::near, 0.1);
  ASSERT_EQ(found.pieces.size(), 2u);
  EXPECT_NEAR(found.volumes[0], 8, 1e-12);
  EXPECT_NEAR(found.volumes[1], 1, 1e-12);
  EXPECT_NEAR(bounds_of(found.pieces[0].drawn.points).center().x(), 5, 1e-12);
  EXPECT_EQ(found.pieces[1].drawn.triangles.rows(), 12);
}

TEST(SurfacePieces, OnePieceKeepsEveryBit) {
  const TriMesh ring = test::torus_surface(1, 0.4, 20, 10);
  EXPECT_EQ(pieces_of({ring, {}}, Joining::near, 0.1).pieces[0].boundary.points, ring.points);
}

TEST(SurfaceThickness, IsThatOfAPlateAndOfATube) {
  const auto plate = sampled_thickness(test::box_surface(Vec3(1, 0.05, 1)));
  EXPECT_NEAR(plate[plate.size() / 2].thickness, 0.1, 1e-6);
  EXPECT_NEAR(plate.front().thickness, 0.1, 1e-6);
  // The sides of the plate, a twentieth of its surface, are far from each other.
  EXPECT_NEAR(plate.back().thickness, 2, 1e-6);
  const auto ring = sampled_thickness(test::torus_surface(1, 0.2, 60, 30));
  EXPECT_NEAR(ring[ring.size() / 2].thickness, 0.4, 0.01);
}

TEST(SurfaceThickness, OfAPlateThatIsNextToNothingIsFound) {
  const auto plate = sampled_thickness(test::box_surface(Vec3(1, 5e-10, 1)));
  ASSERT_GT(plate.size(), 1900u);
  EXPECT_NEAR(plate[plate.size() / 2].thickness, 1e-9, 1e-12);
}

TEST(SurfaceThickness, SpacingAndVerticesBelongTogether) {
  for (const double vertices : {100.0, 4000.0, 2e5})
    EXPECT_NEAR(vertices_for(0.3, 4, spacing_for(0.3, 4, vertices)) / vertices, 1, 1e-6);
}

}  // namespace surface_pieces_test
}  // namespace supple
