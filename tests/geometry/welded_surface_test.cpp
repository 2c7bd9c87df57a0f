// Tests that vertices at one place become one, and that everything that is left tells where it came from.
#include "geometry/triangles/welded_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "base/error.h"
#include "support/surfaces.h"

namespace supple {
namespace welded_surface_test {

// Gives each triangle vertices of its own, as an STL file does.
TriMesh soup_of(const TriMesh& mesh) {
  TriMesh soup{Positions(3 * mesh.triangles.rows(), 3), mesh.triangles};
  for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
    soup.points.row(i) = mesh.points.row(mesh.triangles.data()[i]);
    soup.triangles.data()[i] = std::int32_t(i);
  }
  return soup;
}

std::string refusal(const TriMesh& mesh, double tolerance) {
  try {
    welded(mesh, tolerance, "shirt.stl");
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(WeldedSurface, JoinsTheVerticesOfASoup) {
  const TriMesh box = test::box_surface(Vec3(1, 2, 3)), soup = soup_of(box);
  const WeldedSurface joined = welded(soup, 0, "box");
  ASSERT_EQ(joined.mesh.points.rows(), 8);
  ASSERT_EQ(joined.mesh.triangles.rows(), 12);
  for (Eigen::Index t = 0; t < 12; ++t) {
    EXPECT_EQ(joined.triangle_source[std::size_t(t)], t);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = joined.mesh.triangles(t, k);
      EXPECT_EQ(joined.mesh.points.row(v), soup.points.row(soup.triangles(t, k)));
      EXPECT_EQ(joined.vertex_target[std::size_t(soup.triangles(t, k))], v);
    }
  }
  for (std::int32_t v = 0; v < 8; ++v) {
    const std::int32_t source = joined.vertex_source[std::size_t(v)];
    EXPECT_EQ(joined.mesh.points.row(v), soup.points.row(source));
    EXPECT_EQ(joined.vertex_target[std::size_t(source)], v);
  }
}

TEST(WeldedSurface, JoinsVerticesWithinATolerance) {
  TriMesh soup = soup_of(test::sphere_surface(1, 24, 16));
  std::mt19937 random(5);
  for (double& x : soup.points.reshaped()) x += 1e-4 * (double(random()) / double(std::mt19937::max()) - 0.5);
  EXPECT_EQ(welded(soup, 0, "ball").mesh.points.rows(), soup.points.rows());
  const WeldedSurface joined = welded(soup, 4e-4, "ball");
  EXPECT_EQ(joined.mesh.points.rows(), test::sphere_surface(1, 24, 16).points.rows());
  EXPECT_EQ(joined.mesh.triangles.rows(), soup.triangles.rows());
}

TEST(WeldedSurface, DoesNotShrinkAChainOfNearVerticesToOne) {
  TriMesh strip{Positions(22, 3), Triangles(20, 3)};
  for (std::int32_t i = 0; i < 11; ++i) {
    strip.points.row(2 * i) << 0.1 * i, 0, 0;
    strip.points.row(2 * i + 1) << 0.1 * i, 1, 0;
    if (i == 10) break;
    strip.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    strip.triangles.row(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  const TriMesh joined = welded(strip, 0.15, "strip").mesh;
  EXPECT_EQ(joined.points.rows(), 12);  // every other one is left
  EXPECT_NEAR(bounds_of(joined.points).extent().x(), 1, 1e-12);
}

TEST(WeldedSurface, LeavesOutFlatAndRepeatedTrianglesAndUnusedVertices) {
  TriMesh mesh{Positions(7, 3), Triangles(5, 3)};
  mesh.points << 9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 0, 0, 0, 0, 0;
  mesh.triangles << 1, 2, 5,  // flat
      1, 2, 3, 2, 4, 3,       // a square
      3, 2, 6,                // the first one again, turned over
      1, 6, 4;                // two corners at one place
  const WeldedSurface joined = welded(mesh, 0, "square");
  EXPECT_EQ(joined.mesh.points.rows(), 4);
  EXPECT_EQ(joined.triangle_source, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(joined.vertex_target[0], -1);
  EXPECT_EQ(joined.vertex_target[5], -1);
}

TEST(WeldedSurface, NamesTheFormerSeams) {
  TriMesh square{Positions(6, 3), Triangles(2, 3)};
  square.points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0;
  square.triangles << 0, 1, 2, 3, 4, 5;
  const WeldedSurface cut = welded(square, 0, "square");
  ASSERT_EQ(former_seams(cut).size(), 1u);
  const auto [low, high] = former_seams(cut)[0];
  EXPECT_EQ(cut.mesh.points.row(low), square.points.row(0));
  EXPECT_EQ(cut.mesh.points.row(high), square.points.row(2));
  EXPECT_TRUE(former_seams(welded(cut.mesh, 0, "square")).empty());
}

TEST(WeldedSurface, OpensNoCrackWhereATriangleIsFlat) {
  // Vertices 4 and 5 lie on the diagonal of a square; triangles without area join them to it.
  TriMesh mesh{Positions(6, 3), Triangles(6, 3)};
  mesh.points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 0, 0.25, 0.25, 0;
  mesh.triangles << 0, 1, 2,      // one side of the diagonal
      0, 2, 4, 0, 4, 5,           // flat
      0, 5, 3, 5, 4, 3, 4, 2, 3;  // the other side
  const WeldedSurface joined = welded(mesh, 0, "square");
  EXPECT_EQ(joined.mesh.points.rows(), 6);
  EXPECT_EQ(joined.mesh.triangles.rows(), 6);
  std::map<std::set<std::int32_t>, int> edges;
  double area = 0;
  for (Eigen::Index t = 0; t < joined.mesh.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return joined.mesh.points.row(joined.mesh.triangles(t, k)); };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).z();
    for (int k = 0; k < 3; ++k) {
      ++edges[{joined.mesh.triangles(t, k), joined.mesh.triangles(t, (k + 1) % 3)}];
      const std::int32_t source = joined.corner_source[std::size_t(t)][std::size_t(k)];
      if (source < 0) continue;
      EXPECT_EQ(joined.mesh.points.row(joined.mesh.triangles(t, k)), mesh.points.row(source));
    }
  }
  EXPECT_EQ(area, 1);
  EXPECT_EQ(std::ranges::count(edges, 1, [](const auto& edge) { return edge.second; }), 4);  // the border
  EXPECT_EQ(std::ranges::count(joined.triangle_source, 0), 3);  // the first triangle was cut in three
  EXPECT_TRUE(former_seams(joined).empty());
}

TEST(WeldedSurface, RefusesNonsense) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  EXPECT_EQ(refusal(box, -1), "shirt.stl: cannot be welded within -1 m; 0 or more is allowed");
  EXPECT_EQ(refusal(box, std::nan("")), "shirt.stl: cannot be welded within nan m; 0 or more is allowed");
  EXPECT_EQ(refusal({}, 0), "shirt.stl: has no triangles");
  EXPECT_EQ(refusal(box, 10), "shirt.stl: has no triangle with an area");
  TriMesh broken = box;
  broken.triangles(3, 1) = 8;
  EXPECT_EQ(refusal(broken, 0.1), "shirt.stl: triangle 4 names vertex 8, but there are 8 (counted from 0)");
  broken = box;
  broken.points(broken.triangles(0, 0), 1) = infinity;
  EXPECT_NE(refusal(broken, 0.1).find("is not finite"), std::string::npos);
}

}  // namespace welded_surface_test
}  // namespace supple
