#include "geometry/shapes/rounded_prism.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>

namespace supple {
namespace rounded_prism_test {

// Returns the volume that a surface encloses; negative where its triangles look inward.
double volume_of(const TriMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Vec3 a = mesh.points.row(mesh.triangles(t, 0)), b = mesh.points.row(mesh.triangles(t, 1)),
               c = mesh.points.row(mesh.triangles(t, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

void expect_closed(const TriMesh& mesh) {
  // Vertices at one place, as at the poles of a ball, count as one.
  std::map<std::array<long, 3>, int> known;
  std::map<std::pair<int, int>, int> edges;
  const auto number = [&](std::int32_t v) {
    const Vec3 at = 1e7 * Vec3(mesh.points.row(v));
    return known.try_emplace({std::lround(at.x()), std::lround(at.y()), std::lround(at.z())}, int(known.size()))
        .first->second;
  };
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{number(mesh.triangles(t, k)), number(mesh.triangles(t, (k + 1) % 3))}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(RoundedPrism, OnePointMakesABallAndTwoARod) {
  constexpr double r = 0.1;
  const TriMesh ball = surface_of({{{0.3, 0.2}}, r, -r, r, r});
  expect_closed(ball);
  for (Eigen::Index v = 0; v + 2 < ball.points.rows(); ++v)
    EXPECT_NEAR((Vec3(ball.points.row(v)) - Vec3(0.3, 0.2, 0)).norm(), r, 1e-12);
  const double ideal = 4 * std::numbers::pi * r * r * r / 3;
  EXPECT_NEAR(volume_of(ball), ideal, 0.03 * ideal);

  const TriMesh rod = surface_of({{{-0.5, 0}, {0.5, 0}, {0.1, 0}}, r, -r, r, r});
  expect_closed(rod);
  const double with_length = ideal + std::numbers::pi * r * r;
  EXPECT_NEAR(volume_of(rod), with_length, 0.03 * with_length);
}

TEST(RoundedPrism, APlateIsWiderThanItsPointsByTheMarginAndKeepsItsHeight) {
  const TriMesh plate = surface_of({{{0, 0}, {2, 0}, {2, 1}, {0, 1}, {1, 0.5}}, 0.1, 0.3, 0.7, 0.05});
  expect_closed(plate);
  const Bounds box = bounds_of(plate.points);
  EXPECT_LT((box.lower - Vec3(-0.1, -0.1, 0.3)).norm(), 1e-12);
  EXPECT_LT((box.upper - Vec3(2.1, 1.1, 0.7)).norm(), 1e-12);
  const double sharp = (2 + 2 * 0.3 + std::numbers::pi * 0.01) * 0.4;  // without bevels
  EXPECT_LT(volume_of(plate), sharp);
  EXPECT_GT(volume_of(plate), 0.97 * sharp);

  const TriMesh sharp_edges = surface_of({{{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0, 0, 1, 0});
  expect_closed(sharp_edges);
  EXPECT_NEAR(volume_of(sharp_edges), 2, 1e-12);
}

TEST(RoundedPrism, EqualPointsAreOne) {
  const TriMesh ball = surface_of({{{1, 1}, {1, 1}, {1, 1}}, 0.1, -0.1, 0.1, 0.1});
  expect_closed(ball);
  EXPECT_LT((bounds_of(ball.points).extent() - Vec3(0.2, 0.2, 0.2)).norm(), 1e-12);
}

}  // namespace rounded_prism_test
}  // namespace supple
