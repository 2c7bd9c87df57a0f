// Tests the subdivided surfaces of cloth: what stays, what stays closed, and what gets smoother.
#include "geometry/skins/loop_subdivision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "geometry/meshes/cloth.h"
#include "geometry/skins/flat_places.h"
#include "support/surfaces.h"

namespace supple {
namespace loop_subdivision_test {

struct Drawn {
  Skin skin;
  std::vector<std::int32_t> vertex_of;
  SurfaceWeights weights;
};

Drawn subdivided(const TriMesh& mesh, int levels) {
  Drawn drawn;
  drawn.skin = skin_of_surface(mesh.points, mesh.triangles, 1, drawn.vertex_of);
  drawn.skin.flat = flat_places(drawn.skin, drawn.vertex_of, 1);
  drawn.weights = subdivide(drawn.skin, drawn.vertex_of, mesh.points, levels);
  return drawn;
}

TriMesh grid(int cells) { return cloth_grid({1, 1}, {cells, cells}).surface; }

// Counts the triangles at each edge, where vertices at one place are one.
std::map<int, int> edges_by_triangles(const TriMesh& mesh) {
  std::map<std::array<long, 3>, int> node;
  const auto node_of = [&](std::int32_t v) {
    const Vec3 place = 1e6 * mesh.points.row(v).transpose();
    return node.try_emplace({std::lround(place.x()), std::lround(place.y()), std::lround(place.z())}, int(node.size()))
        .first->second;
  };
  std::map<std::pair<int, int>, int> triangles;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k)
      ++triangles[std::minmax({node_of(mesh.triangles(t, k)), node_of(mesh.triangles(t, (k + 1) % 3))})];
  }
  std::map<int, int> count;
  for (const auto& [edge, of] : triangles) ++count[of];
  return count;
}

// Makes a cube of a metre.
TriMesh cube() {
  TriMesh mesh;
  mesh.points.resize(8, 3);
  for (int v = 0; v < 8; ++v) mesh.points.row(v) << (v & 1), (v >> 1 & 1), (v >> 2 & 1);
  mesh.triangles.resize(12, 3);
  mesh.triangles << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
      3, 7, 5;
  return mesh;
}

TEST(LoopSubdivision, TheWeightsOfEachVertexSumToOne) {
  for (const TriMesh& mesh : {grid(5), test::torus_surface(1, 0.3, 12, 8), cube()}) {
    const Drawn drawn = subdivided(mesh, 2);
    ASSERT_EQ(drawn.weights.rows(), drawn.skin.rest.points.rows());
    ASSERT_EQ(drawn.skin.rest.triangles.rows(), 16 * mesh.triangles.rows());
    for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
      const auto begin = drawn.weights.weight.begin();
      EXPECT_NEAR(std::accumulate(begin + drawn.weights.begin[std::size_t(v)],
                                  begin + drawn.weights.begin[std::size_t(v) + 1], 0.0),
                  1, 1e-12);
    }
  }
}

// A flat cloth stays flat and keeps its outline, and each of its points stays at its place in the pattern.
TEST(LoopSubdivision, AFlatClothStaysWhereItIs) {
  const TriMesh mesh = grid(6);
  const Drawn drawn = subdivided(mesh, 2);
  const Vec3 right = Vec3(1, 2, 0.5), up = Vec3(-0.3, 1, 2);
  const Positions moved = mesh.points.col(0) * right.transpose() + mesh.points.col(1) * up.transpose();
  double furthest = 0;
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
    const auto& [u, w] = drawn.skin.square[std::size_t(v)];
    furthest = std::max(furthest, (weighted_point(drawn.weights, v, moved) - u * right - w * up).norm());
  }
  EXPECT_LT(furthest, 1e-6);
  const Vec3 normal = right.cross(up).normalized();
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v)
    EXPECT_NEAR(weighted_point(drawn.weights, v, moved).dot(normal), 0, 1e-12);
  const Bounds box = bounds_of(drawn.skin.rest.points);
  EXPECT_NEAR((box.lower - Vec3(0, 0, 0)).norm() + (box.upper - Vec3(1, 1, 0)).norm(), 0, 1e-12);
}

// Two surfaces with a common border stay joined there, whatever lies beyond it.
TEST(LoopSubdivision, ABorderDependsOnItsOwnVerticesAlone) {
  const TriMesh mesh = grid(6);
  const Drawn drawn = subdivided(mesh, 2);
  int checked = 0, corners = 0;
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
    if (drawn.skin.flat[std::size_t(v)][2] > 1e-9) continue;
    ++checked;
    const std::int32_t begin = drawn.weights.begin[std::size_t(v)], end = drawn.weights.begin[std::size_t(v) + 1];
    for (std::int32_t i = begin; i < end; ++i)
      EXPECT_EQ(drawn.skin.flat[std::size_t(drawn.weights.vertex[std::size_t(i)])][2], 0);
    if (end - begin == 1) ++corners;
  }
  EXPECT_EQ(checked, 4 * 6 * 4);
  EXPECT_EQ(corners, 4);
}

TEST(LoopSubdivision, ClosedSurfacesStayClosed) {
  for (const TriMesh& mesh : {test::torus_surface(1, 0.3, 12, 8), cube()}) {
    Drawn drawn = subdivided(mesh, 2);
    const std::map<int, int> edges = edges_by_triangles(drawn.skin.rest);
    EXPECT_EQ(edges.size(), 1u);
    EXPECT_EQ(edges.begin()->first, 2);
  }
}

// The edges of a cube are sharp, so it keeps them.
TEST(LoopSubdivision, SharpEdgesStay) {
  const Drawn drawn = subdivided(cube(), 3);
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
    const Vec3 place = drawn.skin.rest.points.row(v);
    EXPECT_NEAR((place - Vec3::Constant(0.5)).cwiseAbs().maxCoeff(), 0.5, 1e-12);
  }
}

// Three triangles at one edge, two pieces that touch at a vertex, and a vertex without triangles.
TEST(LoopSubdivision, NonManifoldSurfacesSurvive) {
  TriMesh mesh;
  mesh.points.resize(9, 3);
  mesh.points << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, -1, 0.1, 0.5, 0, 1, 0.2, 2, 0, 0.8, 2, 0, 9, 9, 9, 0.5, 0.1, -1;
  mesh.triangles.resize(5, 3);
  mesh.triangles << 0, 1, 2, 1, 0, 3, 0, 1, 4, 2, 6, 5, 0, 8, 1;
  const Drawn drawn = subdivided(mesh, 2);
  EXPECT_EQ(drawn.skin.rest.triangles.rows(), 80);
  EXPECT_TRUE(drawn.skin.rest.points.allFinite());
  EXPECT_EQ(edges_by_triangles(drawn.skin.rest)[4], 4) << "the edge of four triangles, in four pieces";
  EXPECT_EQ(bounds_of(drawn.skin.rest.points).upper.maxCoeff(), 2) << "the vertex without triangles is not drawn";
}

// Cloth does not sink into a ball that it lies on, nor stand off: it is nearer to it than its straight edges were.
TEST(LoopSubdivision, ABallStaysAsLargeAsItIs) {
  const auto furthest = [](int around) {
    const Drawn drawn = subdivided(test::sphere_surface(1, around, around / 2), 2);
    double most = 0;
    for (Eigen::Index v = 0; v < drawn.skin.rest.points.rows(); ++v) {
      const Vec3 place = drawn.skin.rest.points.row(v);
      if (std::abs(place.y()) < 0.6) most = std::max(most, std::abs(place.norm() - 1));
    }
    return most;
  };
  const double sagitta = 1 - std::cos(std::numbers::pi / 48);  // of a straight edge
  EXPECT_LT(furthest(48), 0.5 * sagitta);
  EXPECT_GT(furthest(24), 2 * furthest(48));
}

TEST(LoopSubdivision, ValuesStayWithinThoseTheyFollowFrom) {
  const TriMesh mesh = grid(4);
  const Drawn drawn = subdivided(mesh, 2);
  std::vector<double> values(std::size_t(mesh.points.rows()), 0.0);
  values[12] = 1;
  double most = 0;
  for (Eigen::Index v = 0; v < drawn.weights.rows(); ++v) {
    const double value = weighted_value(drawn.weights, v, values);
    EXPECT_GE(value, 0);
    EXPECT_LE(value, 1);
    most = std::max(most, value);
  }
  EXPECT_GT(most, 0.5);
}

TEST(FlatPlaces, DistancesAreThoseToTheNearestOpenBorder) {
  const Drawn drawn = subdivided(grid(8), 0);
  for (std::size_t v = 0; v < drawn.vertex_of.size(); ++v) {
    const Vec3 place = drawn.skin.rest.points.row(Eigen::Index(v));
    const double expected = std::min({place.x(), place.y(), 1 - place.x(), 1 - place.y()});
    EXPECT_NEAR(drawn.skin.flat[v][2], expected, 1e-6);
    EXPECT_NEAR(drawn.skin.flat[v][0], place.x(), 1e-6);
  }
  for (const FlatPlace& place : subdivided(cube(), 0).skin.flat) EXPECT_EQ(place[2], float(no_border));
}

}  // namespace loop_subdivision_test
}  // namespace supple
