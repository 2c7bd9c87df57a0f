// Tests that surfaces of all kinds become meshes of nearly equal edges, keep their shapes, borders and lines, and tell
// where on the input each vertex lies.
#include "geometry/triangles/remesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <random>
#include <set>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "geometry/triangles/welded_surface.h"
#include "support/surfaces.h"

namespace supple {
namespace remesh_test {

Vec3 corner_of(const TriMesh& mesh, Eigen::Index t, int k) { return mesh.points.row(mesh.triangles(t, k % 3)); }

Vec3 area_of(const TriMesh& mesh, Eigen::Index t) {
  const Vec3 a = corner_of(mesh, t, 0);
  return 0.5 * (corner_of(mesh, t, 1) - a).cross(corner_of(mesh, t, 2) - a);
}

double total_area(const TriMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) sum += area_of(mesh, t).norm();
  return sum;
}

// Counts the triangles of each edge; its vertices are in increasing order.
std::map<std::array<int, 2>, int> edges_of(const TriMesh& mesh) {
  std::map<std::array<int, 2>, int> edges;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3)});
      ++edges[{low, high}];
    }
  }
  return edges;
}

double length_of(const TriMesh& mesh, const std::array<int, 2>& edge) {
  return (mesh.points.row(edge[0]) - mesh.points.row(edge[1])).norm();
}

double mean_length(const TriMesh& mesh) {
  double sum = 0;
  const auto edges = edges_of(mesh);
  for (const auto& [edge, count] : edges) sum += length_of(mesh, edge);
  return sum / double(edges.size());
}

// Sums the lengths of the edges that have so many triangles.
double length_of_edges_with(const TriMesh& mesh, int triangles) {
  double sum = 0;
  for (const auto& [edge, count] : edges_of(mesh))
    if (count == triangles) sum += length_of(mesh, edge);
  return sum;
}

int euler_characteristic(const TriMesh& mesh) {
  return int(mesh.points.rows()) - int(edges_of(mesh).size()) + int(mesh.triangles.rows());
}

double share_of_angles_below(const TriMesh& mesh, double degrees) {
  double below = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = corner_of(mesh, t, k + 1) - corner_of(mesh, t, k),
                 b = corner_of(mesh, t, k + 2) - corner_of(mesh, t, k);
      below += std::atan2(a.cross(b).norm(), a.dot(b)) < degrees * std::numbers::pi / 180 ? 1 : 0;
    }
  }
  return below / double(3 * mesh.triangles.rows());
}

Vec3 point_at(const TriMesh& mesh, const RemeshedPlace& place) {
  Vec3 p = Vec3::Zero();
  for (int k = 0; k < 3; ++k) p += place.weights[k] * corner_of(mesh, place.triangle, k);
  return p;
}

// Checks that all vertices are used, and that no triangle is flat or there twice.
void expect_clean(const TriMesh& mesh, double size) {
  std::set<int> used;
  for (const std::int32_t v : mesh.triangles.reshaped()) used.insert(v);
  EXPECT_EQ(std::ssize(used), mesh.points.rows());
  std::set<std::array<int, 3>> triangles;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    std::array<int, 3> corners{mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)};
    std::ranges::sort(corners);
    EXPECT_TRUE(triangles.insert(corners).second) << "triangle " << t << " is there twice";
    EXPECT_GT(area_of(mesh, t).norm(), 1e-9 * size * size);
  }
}

// Checks what holds for every result on a surface that its edges can follow: it is clean, and all places are right.
void expect_sound(const TriMesh& input, const RemeshedSurface& result) {
  const double size = bounds_of(input.points).diagonal();
  expect_clean(result.mesh, size);
  EXPECT_EQ(std::ssize(result.places), result.mesh.points.rows());
  EXPECT_EQ(std::ssize(result.corners), result.mesh.triangles.rows());
  for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const RemeshedPlace& place = result.corners[std::size_t(t)][std::size_t(k)];
      EXPECT_GE(place.weights.minCoeff(), 0);
      EXPECT_NEAR(place.weights.sum(), 1, 1e-12);
      EXPECT_LT((point_at(input, place) - corner_of(result.mesh, t, k)).norm(), 1e-12 * size);
    }
  }
  for (Eigen::Index v = 0; v < result.mesh.points.rows(); ++v)
    EXPECT_LT((point_at(input, result.places[std::size_t(v)]) - result.mesh.points.row(v).transpose()).norm(),
              1e-12 * size);
}

void expect_even(const TriMesh& mesh, double edge_length) {
  EXPECT_NEAR(mean_length(mesh), edge_length, 0.1 * edge_length);
  EXPECT_LT(share_of_angles_below(mesh, 25), 0.05);
}

// Makes (columns + 1) * (rows + 1) vertices of places in the unit square.
template <class Shape>
TriMesh grid(int columns, int rows, const Shape& shape) {
  TriMesh mesh{Positions((columns + 1) * (rows + 1), 3), Triangles(2 * columns * rows, 3)};
  const auto name = [&](int i, int j) { return std::int32_t(j * (columns + 1) + i); };
  Eigen::Index t = 0;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.points.row(name(i, j)) = shape(double(i) / columns, double(j) / rows).transpose();
      if (i == columns || j == rows) continue;
      mesh.triangles.row(t++) << name(i, j), name(i + 1, j), name(i + 1, j + 1);
      mesh.triangles.row(t++) << name(i, j), name(i + 1, j + 1), name(i, j + 1);
    }
  }
  return mesh;
}

TriMesh flat_grid(int columns, int rows) {
  return grid(columns, rows, [](double s, double t) { return Vec3(s, t, 0); });
}

// Makes a cylinder of radius 1 and height 2 around the y axis, with a seam at its first column.
TriMesh cut_cylinder(int columns, int rows) {
  return grid(columns, rows, [&](double s, double t) {
    const double angle = 2 * std::numbers::pi * std::fmod(s, 1.0);
    return Vec3(std::cos(angle), 2 * t, std::sin(angle));
  });
}

RemeshedSurface remeshed_to(const TriMesh& mesh, double edge_length) {
  return remeshed(mesh, {.edge_length = edge_length}, "surface");
}

std::string refusal(const TriMesh& mesh, const RemeshOptions& options) {
  try {
    remeshed(mesh, options, "shirt.obj");
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Remeshed, SphereBecomesEvenAndKeepsItsShape) {
  const TriMesh ball = test::sphere_surface(1, 60, 40);
  for (const double length : {0.15, 0.04}) {
    const RemeshedSurface result = remeshed_to(ball, length);
    expect_sound(ball, result);
    expect_even(result.mesh, length);
    EXPECT_EQ(share_of_angles_below(result.mesh, 25), 0);
    EXPECT_NEAR(total_area(result.mesh), total_area(ball), 0.01 * total_area(ball));
    for (const auto& [edge, count] : edges_of(result.mesh)) EXPECT_EQ(count, 2);
    EXPECT_EQ(euler_characteristic(result.mesh), 2);
    for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) {
      const Vec3 outward = corner_of(result.mesh, t, 0).normalized();
      EXPECT_GT(area_of(result.mesh, t).normalized().dot(outward), 0.9);
    }
  }
}

TEST(Remeshed, FineMeshBecomesCoarse) {
  const TriMesh torus = test::torus_surface(1, 0.4, 160, 80);
  const RemeshedSurface result = remeshed_to(torus, 0.12);
  expect_sound(torus, result);
  expect_even(result.mesh, 0.12);
  EXPECT_EQ(euler_characteristic(result.mesh), 0);
  EXPECT_NEAR(total_area(result.mesh), total_area(torus), 0.015 * total_area(torus));
  EXPECT_LT(result.mesh.triangles.rows(), torus.triangles.rows() / 8);
}

TEST(Remeshed, CylinderKeepsItsTwoBorders) {
  const TriMesh cylinder = cut_cylinder(64, 1);
  const RemeshedSurface result = remeshed_to(cylinder, 0.1);
  expect_sound(cylinder, result);
  expect_even(result.mesh, 0.1);
  EXPECT_EQ(euler_characteristic(result.mesh), 0);
  EXPECT_NEAR(total_area(result.mesh), total_area(cylinder), 0.01 * total_area(cylinder));
  const double rim = 64 * 2 * std::sin(std::numbers::pi / 64);
  EXPECT_NEAR(length_of_edges_with(result.mesh, 1), 2 * rim, 0.005 * rim);
  int lower = 0, upper = 0;
  for (const auto& [edge, count] : edges_of(result.mesh)) {
    if (count != 1) continue;
    const double a = result.mesh.points(edge[0], 1), b = result.mesh.points(edge[1], 1);
    EXPECT_EQ(a, b);
    lower += a == 0 ? 1 : 0;
    upper += a == 2 ? 1 : 0;
  }
  EXPECT_NEAR(lower, rim / 0.1, 12);
  EXPECT_NEAR(upper, rim / 0.1, 12);
}

TEST(Remeshed, SheetsThatMeetKeepTheirSeam) {
  TriMesh sheets = test::together(flat_grid(10, 10), grid(10, 10, [](double s, double t) { return Vec3(-s, t, 0); }));
  sheets = test::together(sheets, grid(10, 10, [](double s, double t) { return Vec3(0, t, s); }));
  for (const double length : {0.06, 0.2}) {
    const RemeshedSurface result = remeshed_to(sheets, length);
    expect_sound(sheets, result);
    expect_even(result.mesh, length);
    EXPECT_NEAR(total_area(result.mesh), 3, 1e-9);
    EXPECT_NEAR(length_of_edges_with(result.mesh, 3), 1, 1e-9);
    EXPECT_NEAR(length_of_edges_with(result.mesh, 1), 9, 1e-9);
    for (const auto& [edge, count] : edges_of(result.mesh)) {
      if (count != 3) continue;
      for (const int v : edge) EXPECT_TRUE(result.mesh.points(v, 0) == 0 && result.mesh.points(v, 2) == 0);
    }
  }
}

TEST(Remeshed, SquareWithAHoleKeepsItsCornersAndItsHole) {
  TriMesh square = flat_grid(12, 12);
  std::vector<Eigen::Index> kept;  // all but the middle 4 x 4 cells
  for (Eigen::Index t = 0; t < square.triangles.rows(); ++t) {
    const Vec3 middle = (corner_of(square, t, 0) + corner_of(square, t, 1) + corner_of(square, t, 2)) / 3;
    if ((middle - Vec3(0.5, 0.5, 0)).cwiseAbs().maxCoeff() > 1.0 / 6) kept.push_back(t);
  }
  square.triangles = square.triangles(kept, Eigen::all).eval();
  const RemeshedSurface result = remeshed_to(square, 0.05);
  expect_sound(square, result);
  expect_even(result.mesh, 0.05);
  EXPECT_EQ(euler_characteristic(result.mesh), 0);
  EXPECT_NEAR(total_area(result.mesh), 8.0 / 9, 1e-9);
  EXPECT_NEAR(length_of_edges_with(result.mesh, 1), 4 + 4.0 / 3, 1e-9);
  for (const double x : {0.0, 4.0 / 12, 8.0 / 12, 1.0}) {
    for (const double y : {0.0, 4.0 / 12, 8.0 / 12, 1.0}) {
      if ((x == 0 || x == 1) != (y == 0 || y == 1)) continue;  // not a corner
      EXPECT_LT((result.mesh.points.rowwise() - Eigen::RowVector3d(x, y, 0)).rowwise().norm().minCoeff(), 1e-15);
    }
  }
  for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) EXPECT_GT(area_of(result.mesh, t).z(), 0);
}

TEST(Remeshed, RoundHoleKeepsItsShape) {
  // The outer border is a square, the inner one a circle.
  const TriMesh ring = grid(80, 6, [](double s, double t) {
    const double angle = 2 * std::numbers::pi * std::fmod(s, 1.0);
    const Vec3 way(std::cos(angle), std::sin(angle), 0);
    return Vec3((1 - t) * way / way.cwiseAbs().maxCoeff() + t * 0.3 * way);
  });
  const RemeshedSurface result = remeshed_to(ring, 0.08);
  expect_sound(ring, result);
  expect_even(result.mesh, 0.08);
  EXPECT_NEAR(total_area(result.mesh), total_area(ring), 0.005 * total_area(ring));
  int round = 0;
  for (const auto& [edge, count] : edges_of(result.mesh)) {
    for (const int v : edge) {
      const double radius = result.mesh.points.row(v).norm();
      if (count == 1 && radius < 0.9) {
        EXPECT_NEAR(radius, 0.3, 3e-4);  // the circle of the input is a polygon
        ++round;
      }
    }
  }
  EXPECT_NEAR(round / 2, 2 * std::numbers::pi * 0.3 / 0.08, 5);
}

TEST(Remeshed, SoupOfTrianglesIsJoined) {
  const TriMesh ball = test::sphere_surface(1, 30, 20);
  TriMesh soup{Positions(3 * ball.triangles.rows(), 3), ball.triangles};
  for (Eigen::Index i = 0; i < soup.triangles.size(); ++i) {
    soup.points.row(i) = ball.points.row(ball.triangles.data()[i]);
    soup.triangles.data()[i] = std::int32_t(i);
  }
  const RemeshedSurface result = remeshed_to(soup, 0.15), same = remeshed_to(welded(ball, 0, "ball").mesh, 0.15);
  expect_sound(soup, result);
  EXPECT_EQ(length_of_edges_with(result.mesh, 1), 0);
  EXPECT_EQ(result.mesh.points, same.mesh.points);
  EXPECT_EQ(result.mesh.triangles, same.mesh.triangles);
}

TEST(Remeshed, SliversBecomeEven) {
  for (const auto& [columns, rows] : {std::pair(400, 1), std::pair(3, 90), std::pair(1, 1)}) {
    const TriMesh square = flat_grid(columns, rows);
    const RemeshedSurface result = remeshed_to(square, 0.06);
    expect_sound(square, result);
    expect_even(result.mesh, 0.06);
    EXPECT_NEAR(total_area(result.mesh), 1, 1e-9);
    for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) EXPECT_GT(area_of(result.mesh, t).z(), 0);
  }
}

TEST(Remeshed, CreasesStayWhereTheyAreWanted) {
  const TriMesh box = test::box_surface(Vec3(0.5, 1, 0.25));
  const RemeshedSurface sharp = remeshed_to(box, 0.1);
  expect_sound(box, sharp);
  expect_even(sharp.mesh, 0.1);
  EXPECT_NEAR(total_area(sharp.mesh), total_area(box), 1e-9);
  EXPECT_NEAR(test::six_volumes(sharp.mesh), test::six_volumes(box), 1e-9);
  const RemeshedSurface round = remeshed(box, {.edge_length = 0.1, .crease_angle = std::numbers::pi}, "box");
  expect_sound(box, round);
  expect_even(round.mesh, 0.1);
  EXPECT_LT(test::six_volumes(round.mesh), 0.999 * test::six_volumes(box));
  EXPECT_GT(test::six_volumes(round.mesh), 0.93 * test::six_volumes(box));
}

TEST(Remeshed, SameInputGivesTheSameBits) {
  const TriMesh cylinder = cut_cylinder(40, 7);
  const RemeshedSurface one = remeshed_to(cylinder, 0.07), other = remeshed_to(cylinder, 0.07);
  EXPECT_EQ(one.mesh.points, other.mesh.points);
  EXPECT_EQ(one.mesh.triangles, other.mesh.triangles);
  for (std::size_t v = 0; v < one.places.size(); ++v) {
    EXPECT_EQ(one.places[v].triangle, other.places[v].triangle);
    EXPECT_EQ(one.places[v].weights, other.places[v].weights);
  }
}

TEST(Remeshed, CoordinatesOfATextureCrossNoSeam) {
  const TriMesh cylinder = cut_cylinder(48, 5);
  std::vector<double> u(std::size_t(cylinder.points.rows()));  // from 0 to 1 around the cylinder
  for (std::size_t v = 0; v < u.size(); ++v) u[v] = double(v % 49) / 48;
  const WeldedSurface joined = welded(cylinder, 0, "cylinder");
  RemeshOptions options{.edge_length = 0.15};
  options.lines = former_seams(joined);
  EXPECT_EQ(options.lines.size(), 5u);
  const RemeshedSurface result = remeshed(joined.mesh, options, "cylinder");
  expect_sound(joined.mesh, result);
  expect_even(result.mesh, 0.15);
  for (const auto& corners : result.corners) {
    double low = 1, high = 0;
    for (const RemeshedPlace& place : corners) {
      const std::int32_t source = joined.triangle_source[std::size_t(place.triangle)];
      double own = 0;
      for (int k = 0; k < 3; ++k) own += place.weights[k] * u[std::size_t(cylinder.triangles(source, k))];
      const Vec3 p = point_at(cylinder, {source, place.weights});
      const double turn = std::atan2(p.z(), p.x()) / (2 * std::numbers::pi);
      EXPECT_LT(std::abs(std::remainder(own - turn, 1.0)), 1e-3);
      low = std::min(low, own);
      high = std::max(high, own);
    }
    EXPECT_LT(high - low, 0.05);
  }
}

TEST(Remeshed, NearSheetsDoNotMix) {
  const TriMesh outer = test::sphere_surface(1, 60, 40), inner = test::sphere_surface(0.998, 60, 40);
  const TriMesh both = test::together(outer, inner);
  const RemeshedSurface result = remeshed_to(both, 0.2);
  expect_sound(both, result);
  EXPECT_EQ(euler_characteristic(result.mesh), 4);
  for (const auto& corners : result.corners) {
    std::set<bool> sheets;
    for (const RemeshedPlace& place : corners) sheets.insert(place.triangle < outer.triangles.rows());
    EXPECT_EQ(sheets.size(), 1u);
  }
}

TEST(Remeshed, TrianglesOfAPartFaceOneWay) {
  TriMesh ball = test::sphere_surface(1, 30, 20);
  for (Eigen::Index t = 0; t < ball.triangles.rows(); t += 3) std::swap(ball.triangles(t, 1), ball.triangles(t, 2));
  const RemeshedSurface result = remeshed_to(ball, 0.15);
  expect_sound(ball, result);
  expect_even(result.mesh, 0.15);
  for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t)
    EXPECT_GT(area_of(result.mesh, t).dot(corner_of(result.mesh, t, 0)), 0);
}

TEST(Remeshed, OneSidedStripStaysOneSided) {
  const TriMesh half_turn = grid(60, 6, [](double s, double t) {
    const double angle = 2 * std::numbers::pi * s, twist = 0.5 * angle, r = 1 + 0.3 * (2 * t - 1) * std::cos(twist);
    return Vec3(r * std::cos(angle), 0.3 * (2 * t - 1) * std::sin(twist), r * std::sin(angle));
  });
  const TriMesh strip = welded(half_turn, 1e-9, "strip").mesh;
  const RemeshedSurface result = remeshed_to(strip, 0.08);
  expect_sound(strip, result);
  expect_even(result.mesh, 0.08);
  EXPECT_EQ(euler_characteristic(result.mesh), 0);
  EXPECT_NEAR(total_area(result.mesh), total_area(strip), 0.01 * total_area(strip));
  EXPECT_NEAR(length_of_edges_with(result.mesh, 1), length_of_edges_with(strip, 1), 0.1);
}

TEST(Remeshed, TornSurfacesKeepTheirPiecesAndHoles) {
  const TriMesh ball = test::sphere_surface(1, 24, 16);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t)
      if (random() % 10 != 0) kept.push_back(t);
    const TriMesh torn = welded({ball.points, ball.triangles(kept, Eigen::all)}, 0, "torn").mesh;
    for (const double length : {0.05, 0.5}) {
      const RemeshedSurface result = remeshed_to(torn, length);
      EXPECT_EQ(euler_characteristic(result.mesh), euler_characteristic(torn));
      EXPECT_LT(length_of_edges_with(result.mesh, 1), length_of_edges_with(torn, 1) * (1 + 1e-12));
      for (const auto& [edge, count] : edges_of(result.mesh)) EXPECT_LE(count, 2);
      for (const RemeshedPlace& place : result.places) EXPECT_LT(place.triangle, torn.triangles.rows());
    }
  }
}

TEST(Remeshed, SmallSurfacesSurviveLargeEdges) {
  TriMesh tetrahedron{Positions(4, 3), Triangles(4, 3)}, triangle{Positions(3, 3), Triangles(1, 3)};
  tetrahedron.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  tetrahedron.triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  triangle.points << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  triangle.triangles << 0, 1, 2;
  const TriMesh ball = test::sphere_surface(1, 8, 6), strip = flat_grid(12, 1), fine = test::sphere_surface(1, 30, 20);
  for (const TriMesh& mesh : {tetrahedron, triangle, ball, strip, fine, cut_cylinder(9, 2)}) {
    for (const double crease : {0.3, 1.0, 4.0}) {
      const RemeshedSurface result = remeshed(mesh, {.edge_length = 5, .crease_angle = crease}, "surface");
      expect_clean(result.mesh, bounds_of(mesh.points).diagonal());
      EXPECT_EQ(euler_characteristic(result.mesh), euler_characteristic(welded(mesh, 0, "surface").mesh));
      for (const auto& [edge, count] : edges_of(result.mesh)) EXPECT_LE(count, 2);
    }
  }
}

TEST(Remeshed, ConcaveBordersFoldNothing) {
  // A star with eight points: its border is concave at every second vertex.
  const TriMesh star = welded(grid(64, 5,
                                   [](double s, double t) {
                                     const double angle = 2 * std::numbers::pi * std::fmod(s, 1.0);
                                     const double reach = 0.25 + 1.5 * std::abs(std::fmod(8 * s, 1.0) - 0.5);
                                     return Vec3((1 - t) * reach * Vec3(std::cos(angle), std::sin(angle), 0));
                                   }),
                              0, "star")
                           .mesh;
  for (const double length : {0.3, 0.1, 0.03}) {
    const RemeshedSurface result = remeshed_to(star, length);
    expect_sound(star, result);
    EXPECT_NEAR(total_area(result.mesh), total_area(star), 0.3 * length * total_area(star));
    for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) EXPECT_GT(area_of(result.mesh, t).z(), 0);
  }
}

TEST(Remeshed, BorderOfACoarseHoleIsSplitEvenly) {
  // Neither border turns by more than 45 degrees, so that none has corners.
  const TriMesh ring = welded(grid(10, 1,
                                   [](double s, double t) {
                                     const double angle = 2 * std::numbers::pi * std::fmod(s, 1.0);
                                     return Vec3((1 + t) * Vec3(std::cos(angle), std::sin(angle), 0));
                                   }),
                              0, "ring")
                           .mesh;
  const RemeshedSurface result = remeshed_to(ring, 0.15);
  expect_sound(ring, result);
  expect_even(result.mesh, 0.15);
  EXPECT_NEAR(total_area(result.mesh), total_area(ring), 0.01 * total_area(ring));
  for (const auto& [edge, count] : edges_of(result.mesh)) {
    if (count != 1) continue;
    EXPECT_NEAR(length_of(result.mesh, edge), 0.15, 0.06);
  }
}

TEST(Remeshed, ConesThatTouchStayTogether) {
  TriMesh cones = grid(16, 8, [](double s, double t) {
    const double angle = 2 * std::numbers::pi * std::fmod(s, 1.0), radius = 2 * t - 1;
    return Vec3(radius * std::cos(angle), 2 * radius, std::abs(radius) * std::sin(angle));
  });
  cones = welded(cones, 1e-9, "cones").mesh;
  const RemeshedSurface result = remeshed(cones, {.edge_length = 0.3, .crease_angle = 4}, "cones");
  expect_sound(cones, result);
  EXPECT_EQ(euler_characteristic(result.mesh), euler_characteristic(cones));
  EXPECT_LT(result.mesh.points.rowwise().norm().minCoeff(), 1e-12);  // the common tip
  EXPECT_NEAR(bounds_of(result.mesh.points).extent().y(), 4, 1e-12);
}

TEST(Remeshed, CoarseFoldsKeepTheirArea) {
  // Sheets fold by 50 degrees, to either side in turn, which is less than a crease.
  const double half = 25 * std::numbers::pi / 180;
  const TriMesh folded = grid(8, 4, [&](double s, double t) {
    const int fold = int(std::lround(8 * s));
    return Vec3(s * std::cos(half), fold % 2 * std::sin(half) / 8, t);
  });
  const RemeshedSurface result = remeshed_to(folded, 0.03);
  expect_sound(folded, result);
  EXPECT_LT(share_of_angles_below(result.mesh, 25), 0.05);
  EXPECT_NEAR(total_area(result.mesh), total_area(folded), 0.03 * total_area(folded));
}

TEST(Remeshed, NoiseAndThinTrianglesMakeNoCreases) {
  // A quarter of the triangles have a vertex in the middle of a side, a hair beside it, and one a small pyramid.
  const TriMesh ball = test::sphere_surface(1, 24, 16);
  std::mt19937 random(3);
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v) points.emplace_back(ball.points.row(v));
  for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t) {
    const std::int32_t a = ball.triangles(t, 0), b = ball.triangles(t, 1), c = ball.triangles(t, 2);
    const auto added = std::int32_t(points.size());
    const Vec3 &xa = points[std::size_t(a)], &xb = points[std::size_t(b)], &xc = points[std::size_t(c)];
    if (t == 300) {
      triangles.insert(triangles.end(), {{a, b, added}, {b, c, added}, {c, a, added}});
      points.push_back(1.2 * (xa + xb + xc) / 3);
    } else if (random() % 4 == 0) {
      triangles.insert(triangles.end(), {{a, added, c}, {added, b, c}, {a, b, added}});
      const auto noise = [&] { return 1e-7 * (double(random()) / double(std::mt19937::max()) - 0.5); };
      points.push_back(0.5 * (xa + xb) + Vec3(noise(), noise(), noise()));
    } else {
      triangles.push_back({a, b, c});
    }
  }
  TriMesh noisy{Positions(std::ssize(points), 3), Triangles(std::ssize(triangles), 3)};
  for (std::size_t v = 0; v < points.size(); ++v) noisy.points.row(Eigen::Index(v)) = points[v].transpose();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    noisy.triangles.row(Eigen::Index(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  const RemeshedSurface result = remeshed(noisy, {.edge_length = 0.3, .crease_angle = 0.7}, "ball");
  expect_sound(noisy, result);
  expect_even(result.mesh, 0.3);
  EXPECT_EQ(share_of_angles_below(result.mesh, 25), 0);
  EXPECT_EQ(euler_characteristic(result.mesh), 2);
}

TEST(Remeshed, RefusesNonsense) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  EXPECT_EQ(refusal(box, {}), "shirt.obj: cannot have edges of 0 m; a length above 0 is allowed");
  EXPECT_EQ(refusal(box, {.edge_length = -0.1}), "shirt.obj: cannot have edges of -0.1 m; a length above 0 is allowed");
  EXPECT_EQ(refusal(box, {.edge_length = infinity}),
            "shirt.obj: cannot have edges of inf m; a length above 0 is allowed");
  EXPECT_EQ(refusal(box, {.edge_length = 0.1, .crease_angle = 0}),
            "shirt.obj: creases and corners cannot be at 0 rad; an angle above 0 is allowed");
  EXPECT_EQ(refusal({}, {.edge_length = 0.1}), "shirt.obj: has no triangles");
  EXPECT_EQ(refusal(box, {.edge_length = 1e-5}),
            "shirt.obj: would have about 6e+11 triangles with edges of 1e-05 m; up to 1e+07 are allowed");
  RemeshOptions options{.edge_length = 0.1};
  options.lines = {{0, 7}};
  EXPECT_EQ(refusal(box, options), "shirt.obj: has no edge between vertices 0 and 7 to keep as a line");
  options.lines = {{0, 99}};
  EXPECT_EQ(refusal(box, options), "shirt.obj: has no edge between vertices 0 and 99 to keep as a line");
}

}  // namespace remesh_test
}  // namespace supple
