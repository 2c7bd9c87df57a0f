// Tests what tells whether a bar is knotted.
#include "app/bench/knotted_bar.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/meshes/mesh.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {
namespace knotted_bar_test {

// Returns a curve that is cut open at its start, with ends that lead away from there.
template <class Curve>
std::vector<Vec3> opened(const Curve& curve, double from, double to) {
  constexpr int edges = 120;
  std::vector<Vec3> line;
  for (int i = 0; i <= edges; ++i) line.push_back(curve(from + (to - from) * i / edges));
  return line;
}

Vec3 trefoil(double t) {
  return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -std::sin(3 * t)};
}
constexpr double pi = 3.14159265358979;

TEST(KnottedBar, HasDeterminant1WhereItCanBePulledStraight) {
  EXPECT_EQ(knot_determinant({Vec3(0, 0, 0), Vec3(1, 0, 0)}), 1);
  const auto helix = [](double t) { return Vec3(t, std::cos(t), std::sin(t)); };
  EXPECT_EQ(knot_determinant(opened(helix, 0, 30)), 1);
}

TEST(KnottedBar, HasDeterminant3WhereItIsATrefoil) {
  std::vector<Vec3> line = opened(trefoil, pi + 0.55, 3 * pi - 0.55);
  line.insert(line.begin(), {Vec3(6, -3.3, 0), Vec3(2.5, -3.2, 0.3)});
  line.insert(line.end(), {Vec3(-2.5, -3.2, -0.3), Vec3(-6, -3.3, 0)});
  EXPECT_EQ(knot_determinant(line), 3);
  for (Vec3& point : line) point.z() = -point.z();
  EXPECT_EQ(knot_determinant(line), 3) << "its mirror image";
  for (Vec3& point : line) point.z() = 0.01 * point.x();
  EXPECT_EQ(knot_determinant(line), 1) << "a flat spiral, without over and under";
}

TEST(KnottedBar, HasDeterminant5WhereItIsAFigureEight) {
  const auto eight = [](double t) {
    return Vec3((2 + std::cos(2 * t)) * std::cos(3 * t), (2 + std::cos(2 * t)) * std::sin(3 * t), std::sin(4 * t));
  };
  std::vector<Vec3> line = opened(eight, 0.05, 2 * pi - 0.05);  // cut where it is outermost
  line.insert(line.begin(), Vec3(9, -0.5, 0));
  line.emplace_back(9, 0.5, 0);
  EXPECT_EQ(knot_determinant(line), 5);
}

TEST(KnottedBar, HasAMiddleLineFromItsEndOn) {
  const TetMesh mesh = box_mesh(Vec3(4, 0.1, 0.1), {160, 3, 3});
  Positions bent = mesh.rest;
  for (auto row : bent.rowwise()) row[1] += row[0] * row[0];
  const std::vector<Vec3> line = middle_line_of_bar(boundary_faces(mesh.tets), mesh.rest, bent);
  ASSERT_GT(line.size(), 70u);
  EXPECT_GT(line.front().x(), line.back().x() + 3.8);
  for (const Vec3& point : line)
    EXPECT_NEAR(point.y() - line.front().y() + line.front().x() * line.front().x(), point.x() * point.x(), 0.08);
}

}  // namespace knotted_bar_test
}  // namespace supple
