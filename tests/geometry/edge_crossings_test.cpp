// Tests the count of edges that pass through triangles.
#include "geometry/triangles/edge_crossings.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

// Counts by another way: solves for where the line of each edge meets the plane of each triangle.
std::int64_t counted_by_solving(const Triangles& triangles, const Positions& x) {
  std::int64_t found = 0;
  for (const auto& edge : edges_by_triangle(triangles).edges) {
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      const auto corner = triangles.row(t);
      if ((corner.array() == edge[0]).any() || (corner.array() == edge[1]).any()) continue;
      const Vec3 a = x.row(corner[0]), from = x.row(edge[0]);
      Eigen::Matrix3d ways;
      ways << Vec3(x.row(corner[1])) - a, Vec3(x.row(corner[2])) - a, from - Vec3(x.row(edge[1]));
      const Vec3 at = ways.partialPivLu().solve(from - a);
      found += at.minCoeff() > 0 && at[2] < 1 && at[0] + at[1] < 1;
    }
  }
  return found;
}

std::int64_t all_of(const EdgeCrossings::Count& count) { return count.apart + count.beside; }

TEST(EdgeCrossings, AreThoseFoundByTryingAllPairs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  constexpr int vertices = 60, count = 80;
  Positions x(vertices, 3);
  for (double& value : x.reshaped()) value = number(random);
  Triangles triangles(count, 3);
  for (int t = 0; t < count; ++t) triangles.row(t) << t % vertices, (t * 7 + 1) % vertices, (t * 11 + 5) % vertices;
  const std::int64_t expected = counted_by_solving(triangles, x);
  EXPECT_GT(expected, 100);
  EdgeCrossings crossings(triangles, Positions::Zero(vertices, 3));
  EXPECT_EQ(all_of(crossings.count(x)), expected);
  x *= -0.5;  // mirrored and smaller, with the same crossings
  EXPECT_EQ(all_of(crossings.count(x)), expected);
}

TEST(EdgeCrossings, AreNoneWhereTrianglesOnlyTouchOrShareVertices) {
  Positions x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0.2, 0.2, 0;
  Triangles triangles(3, 3);
  triangles << 0, 1, 2, 1, 3, 2, 0, 4, 3;
  EdgeCrossings crossings(triangles, x);
  EXPECT_EQ(all_of(crossings.count(x)), 0);  // all in one plane
  x.row(4) << 0.2, 0.2, 1;
  EXPECT_EQ(all_of(crossings.count(x)), 0);  // they share vertex 0, and the edge from 4 to 3 ends on the plane
}

TEST(EdgeCrossings, OfASheetThatIsPushedThroughAnotherOneEndWhenItIsBack) {
  Positions x(6, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0,             // one triangle in the plane z = 0
      0.2, 0.2, 1, 0.3, 0.2, 1, 0.2, 0.3, 1;  // a small one above it
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 3, 4, 5;
  EdgeCrossings crossings(triangles, x);
  EXPECT_EQ(all_of(crossings.count(x)), 0);
  x(3, 2) = -0.1;
  EXPECT_EQ(crossings.count(x).apart, 2);  // both edges of the vertex that came through
  x(3, 2) = 0.1;
  EXPECT_EQ(all_of(crossings.count(x)), 0);
}

TEST(EdgeCrossings, OfAStripThatIsBentBackThroughItsSecondNextTriangleAreBesideEachOther) {
  Positions x(6, 3);
  x << 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0;
  Triangles triangles(4, 3);
  triangles << 0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5;
  EdgeCrossings crossings(triangles, x);
  x.row(4) << 0.3, 0.3, 0.1;
  x.row(5) << 0.3, 0.3, -0.1;
  EXPECT_EQ(crossings.count(x).apart, 0);
  EXPECT_EQ(crossings.count(x).beside, 2);  // edge 4-5 through triangle 0-2-1, and edge 1-2 through triangle 3-4-5
}

}  // namespace
}  // namespace supple
