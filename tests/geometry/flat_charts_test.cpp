// Tests how curved surfaces are laid flat for their print.
#include "geometry/skins/flat_charts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "geometry/skins/skin.h"

namespace supple {
namespace flat_charts_test {

constexpr double pi = std::numbers::pi;

struct Mesh {
  Positions points;
  Triangles triangles;
};

// Returns a surface that goes around y: rings of points, the first of which is in front, and triangles between them.
Mesh around_y(int rings, int points, const std::function<double(double)>& radius,
              const std::function<double(double)>& height) {
  Mesh mesh{Positions(rings * points, 3), Triangles(2 * (rings - 1) * points, 3)};
  Eigen::Index t = 0;
  for (int r = 0; r < rings; ++r) {
    const double s = r / (rings - 1.0);
    for (int p = 0; p < points; ++p) {
      const double angle = 2 * pi * p / points;
      mesh.points.row(r * points + p) =
          Vec3(radius(s) * std::sin(angle), height(s), radius(s) * std::cos(angle)).transpose();
      if (r == 0) continue;
      const int a = (r - 1) * points + p, b = (r - 1) * points + (p + 1) % points, c = a + points, d = b + points;
      mesh.triangles.row(t++) << a, b, d;
      mesh.triangles.row(t++) << a, d, c;
    }
  }
  return mesh;
}

// Returns how a triangle is stretched on the flat cloth: the smaller and the larger factor, both negative where it is
// seen from its back.
Eigen::Vector2d stretch_of(const Mesh& mesh, Eigen::Index t, const LaidTriangle& flat) {
  const auto corner = [&](int k) { return Vec3(mesh.points.row(mesh.triangles(t, k))); };
  const Vec3 u = corner(1) - corner(0), v = corner(2) - corner(0);
  Eigen::Matrix2d rest, laid;
  rest << u.norm(), u.dot(v) / u.norm(), 0, u.cross(v).norm() / u.norm();
  laid << flat[1] - flat[0], flat[2] - flat[0];
  const Eigen::Matrix2d gradient = laid * rest.inverse();
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(gradient);
  const double sign = gradient.determinant() < 0 ? -1 : 1;
  return sign * Eigen::Vector2d(svd.singularValues()[1], svd.singularValues()[0]);
}

// Returns the vertices that have several places.
std::set<std::int32_t> seams_of(const Mesh& mesh, const std::vector<LaidTriangle>& flat) {
  std::map<std::int32_t, Eigen::Vector2d> place;
  std::set<std::int32_t> several;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d& here = flat[std::size_t(t)][std::size_t(k)];
      const auto [known, added] = place.try_emplace(mesh.triangles(t, k), here);
      if ((known->second - here).norm() > 1e-6) several.insert(mesh.triangles(t, k));
    }
  }
  return several;
}

TEST(FlatCharts, ACylinderIsUnrolledWithASeamOnItsBack) {
  const Mesh mesh = around_y(
      13, 40, [](double) { return 0.3; }, [](double s) { return 1.2 * s; });
  const std::vector<LaidTriangle> flat = laid_triangles(mesh.points, mesh.triangles);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Eigen::Vector2d stretch = stretch_of(mesh, t, flat[std::size_t(t)]);
    ASSERT_NEAR(stretch[0], 1, 1e-6);
    ASSERT_NEAR(stretch[1], 1, 1e-6);
  }
  const std::set<std::int32_t> seams = seams_of(mesh, flat);
  EXPECT_GE(seams.size(), 13u);  // from one border to the other
  for (const std::int32_t v : seams) EXPECT_LT(mesh.points(v, 2), -0.25);
}

// The print of a skirt: lines along it and around it, and each line around it about as long as it is.
TEST(FlatCharts, LinesGoAlongASkirtAndAroundIt) {
  const auto radius = [](double s) { return 0.36 - 0.18 * s; };
  const Mesh mesh = around_y(21, 60, radius, [](double s) { return 0.5 * s; });
  const std::vector<LaidTriangle> flat = laid_triangles(mesh.points, mesh.triangles);
  std::map<std::int32_t, Eigen::Vector2d> place;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Eigen::Vector2d stretch = stretch_of(mesh, t, flat[std::size_t(t)]);
    ASSERT_GT(stretch[0], 0.5);
    ASSERT_LT(stretch[1], 2);
    for (int k = 0; k < 3; ++k) place[mesh.triangles(t, k)] = flat[std::size_t(t)][std::size_t(k)];
  }
  for (const auto& [v, at] : place) {
    const std::int32_t of_ring = v - v % 60, of_line = v % 60;
    if (of_line > 22 && of_line < 38) continue;  // the seam is here
    EXPECT_NEAR(at.y(), place[of_ring].y(), 0.01) << v;
    EXPECT_NEAR(at.x(), place[of_line].x(), 0.03) << v;
  }
  for (const std::int32_t v : seams_of(mesh, flat)) EXPECT_TRUE(v % 60 > 22 && v % 60 < 38) << v;
  EXPECT_NEAR(place[20 * 60].y() - place[0].y(), std::hypot(0.5, 0.18), 0.01);
}

TEST(FlatCharts, ABallHasCapsAndAWall) {
  const Mesh mesh = around_y(
      31, 60, [](double s) { return std::sin(pi * (0.02 + 0.96 * s)); },
      [](double s) { return -std::cos(pi * (0.02 + 0.96 * s)); });
  const std::vector<LaidTriangle> flat = laid_triangles(mesh.points, mesh.triangles);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Eigen::Vector2d stretch = stretch_of(mesh, t, flat[std::size_t(t)]).cwiseAbs();
    ASSERT_GT(stretch[0], 0.5);
    ASSERT_LT(stretch[1], 2);
  }
  // The seams are a line on the back and two rings.
  for (const std::int32_t v : seams_of(mesh, flat)) {
    const double high = std::abs(mesh.points(v, 1));
    EXPECT_TRUE(mesh.points(v, 2) < 0 || (high > 0.7 && high < 0.9)) << mesh.points.row(v);
  }
}

TEST(FlatCharts, ATubeThatLiesIsPrintedAlongItself) {
  const Mesh standing = around_y(
      13, 40, [](double) { return 0.3; }, [](double s) { return 1.2 * s; });
  for (const int axis : {0, 2}) {
    Mesh mesh = standing;
    mesh.points.col(axis).swap(mesh.points.col(1));
    const std::vector<LaidTriangle> flat = laid_triangles(mesh.points, mesh.triangles);
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
      ASSERT_NEAR(stretch_of(mesh, t, flat[std::size_t(t)]).cwiseAbs().maxCoeff(), 1, 1e-6) << axis;
  }
}

// Triangles without area, and a surface of nothing but them, are laid somewhere.
TEST(FlatCharts, TrianglesWithoutAreaDoNoHarm) {
  Mesh mesh = around_y(
      5, 12, [](double) { return 0.3; }, [](double s) { return s; });
  mesh.triangles.row(7) << 3, 3, 4;
  for (const LaidTriangle& flat : laid_triangles(mesh.points, mesh.triangles))
    for (const Eigen::Vector2d& at : flat) ASSERT_TRUE(at.allFinite());
  mesh.points.setZero();
  for (const LaidTriangle& flat : laid_triangles(mesh.points, mesh.triangles))
    for (const Eigen::Vector2d& at : flat) ASSERT_TRUE(at.allFinite());
}

// A hole in the front of a tube adds a seam, and the sheet around it stays unstretched.
TEST(FlatCharts, AWallWithAHoleIsUnrolledToo) {
  Mesh mesh = around_y(
      13, 40, [](double) { return 0.3; }, [](double s) { return 1.2 * s; });
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Vec3 corner = mesh.points.row(mesh.triangles(t, 0));
    if (std::hypot(corner.x() - 0.15, corner.y() - 0.6) > 0.12 || corner.z() < 0) kept.push_back(t);
  }
  ASSERT_LT(kept.size(), std::size_t(mesh.triangles.rows()) - 8);
  mesh.triangles = mesh.triangles(kept, Eigen::all).eval();
  const std::vector<LaidTriangle> laid = laid_triangles(mesh.points, mesh.triangles);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    ASSERT_NEAR(stretch_of(mesh, t, laid[std::size_t(t)]).maxCoeff(), 1, 1e-5);
}

// A skin whose squares are not drawn is not laid flat, so that none of its vertices is split.
TEST(FlatCharts, ASkinWithoutSquaresHasNoSeam) {
  const Mesh mesh = around_y(
      13, 40, [](double) { return 0.3; }, [](double s) { return 1.2 * s; });
  std::vector<std::int32_t> vertex_of;
  const Skin skin = skin_of_surface(mesh.points, mesh.triangles, 0.1, vertex_of, BentPart::projected);
  EXPECT_EQ(vertex_of.size(), std::size_t(mesh.points.rows()));
  EXPECT_TRUE(skin.smooth.empty());
  EXPECT_EQ(skin.square.size(), vertex_of.size());
}

// On a seam, a vertex of the skin is split, and its parts keep one normal. Squares are as large as on flat cloth.
TEST(FlatCharts, ASkinIsSplitAtItsSeamAndStaysSmooth) {
  const Mesh mesh = around_y(
      13, 40, [](double) { return 0.3; }, [](double s) { return 1.2 * s; });
  std::vector<std::int32_t> vertex_of;
  const Skin skin = skin_of_surface(mesh.points, mesh.triangles, 0.1, vertex_of);
  ASSERT_EQ(skin.square.size(), vertex_of.size());
  ASSERT_EQ(skin.smooth.size(), vertex_of.size());
  EXPECT_GE(vertex_of.size(), std::size_t(mesh.points.rows()) + 13);
  EXPECT_LT(vertex_of.size(), std::size_t(mesh.points.rows()) + 30);
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    EXPECT_EQ(skin.rest.points.row(Eigen::Index(v)), mesh.points.row(vertex_of[v]));
    EXPECT_EQ(vertex_of[std::size_t(skin.smooth[v])], vertex_of[v]);
  }
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = skin.rest.triangles(t, k), b = skin.rest.triangles(t, (k + 1) % 3);
      const auto &at_a = skin.square[std::size_t(a)], &at_b = skin.square[std::size_t(b)];
      EXPECT_NEAR(std::hypot(at_a[0] - at_b[0], at_a[1] - at_b[1]),
                  (skin.rest.points.row(a) - skin.rest.points.row(b)).norm() / 0.1, 1e-3);
    }
  }
}

}  // namespace flat_charts_test
}  // namespace supple
