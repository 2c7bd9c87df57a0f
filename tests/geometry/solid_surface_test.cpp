// Tests how surfaces that are not closed become solids. What is enclosed is known by formula; boundaries must be closed
// manifolds, and a surface that is closed already must not change by a bit.
#include "geometry/solids/solid_surface.h"
#include "geometry/solids/closed_surface.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "base/error.h"
#include "geometry/files/surface_file.h"
#include "geometry/solids/triangle_solid.h"
#include "geometry/solids/winding_solid.h"
#include "geometry/triangles/triangle_soup.h"
#include "support/surfaces.h"

namespace supple {
namespace solid_surface_test {

using Lines = std::vector<std::string>;

double volume(const TriMesh& mesh) { return test::six_volumes(mesh) / 6; }

// Every edge is run through once in each direction.
bool is_closed_manifold(const TriMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) ++edges[{mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3)}];
  for (const auto& [edge, count] : edges) {
    if (count != 1) return false;
    if (!edges.contains({edge.second, edge.first})) return false;
  }
  return true;
}

SolidSurface made(const TriMesh& mesh, const SurfaceOptions& options, Lines& notes) {
  notes.clear();
  return solid_surface(mesh, options, "x", &notes);
}

std::string refusal_of(const TriMesh& mesh, const SurfaceOptions& options) {
  try {
    solid_surface(mesh, options, "x", nullptr);
    return "";
  } catch (const InputError& error) {
    return error.problems().front().message;
  }
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "found: '" << text << "', expected: '" << part << "'";
}

// A sphere without the triangles whose corners all lie above a height.
TriMesh bowl(double height) {
  const TriMesh ball = test::sphere_surface(1, 60, 40);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < ball.triangles.rows(); ++t) {
    double lowest = 1;
    for (int k = 0; k < 3; ++k) lowest = std::min(lowest, ball.points(ball.triangles(t, k), 1));
    if (lowest < height) kept.push_back(t);
  }
  return {ball.points, ball.triangles(kept, Eigen::all)};
}

// A box whose faces are sheets of their own: no two of them have the same vertices on their common edge.
TriMesh loose_box(std::mt19937* shaker) {
  TriMesh result{Positions(0, 3), Triangles(0, 3)};
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const int cells = 3 + 2 * axis + (side + 1) / 2;
      TriMesh face{Positions((cells + 1) * (cells + 1), 3), Triangles(2 * cells * cells, 3)};
      for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = 2.0 * i / cells - 1;
          p[(axis + 2) % 3] = 2.0 * j / cells - 1;
          face.points.row(j * (cells + 1) + i) = p.transpose();
        }
      }
      for (int j = 0, row = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
          const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
          face.triangles.row(row++) << a, b, d;
          face.triangles.row(row++) << a, d, c;
        }
      }
      const bool turned = shaker != nullptr ? (*shaker)() % 2 == 0 : side < 0;
      result = test::together(result, turned ? test::inside_out(face) : face);
    }
  }
  return result;
}

TEST(SolidSurface, AClosedOneKeepsEveryBit) {
  Lines notes;
  const TriMesh ring = test::torus_surface(1, 0.4, 20, 10);
  const SolidSurface found = made(ring, {}, notes);
  const TriMesh expected = closed_surface(ring, "x", nullptr);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(found.boundary.points, expected.points);
  EXPECT_EQ(found.boundary.triangles, expected.triangles);
  EXPECT_EQ(found.drawn.triangles.rows(), 0);
}

TEST(SolidSurface, HolesAloneAreClosedByCapsThatLeaveTheRestAsItIs) {
  Lines notes;
  const TriMesh open = bowl(0.6);
  const SolidSurface found = made(open, {}, notes);
  EXPECT_TRUE(is_closed_manifold(found.boundary));
  // A ball of radius 1 without its cap above the rim, whose volume is pi h^2 (1 - h / 3).
  const double h = 1 - 0.649448, exact = std::numbers::pi * (4.0 / 3 - h * h * (1 - h / 3));
  EXPECT_NEAR(volume(found.boundary), exact, 0.01 * exact);
  EXPECT_GT(found.boundary.triangles.rows(), open.triangles.rows());
  ASSERT_EQ(notes.size(), 1u);
  expect_part(notes[0], "1 hole was closed with caps, the widest of 1.52 at (");
}

TEST(SolidSurface, WhatToDoWithHolesIsForTheUserToSay) {
  Lines notes;
  const TriMesh open = bowl(0.6);
  expect_part(refusal_of(open, {.close = Closing::never}), "the surface is open");
  expect_part(refusal_of(open, {.close = Closing::never}), "close = \"auto\" closes it");
  const double by_caps = volume(made(open, {.close = Closing::caps}, notes).boundary);
  const SolidSurface wound = made(open, {.close = Closing::winding}, notes);
  EXPECT_TRUE(is_closed_manifold(wound.boundary));
  EXPECT_NEAR(volume(wound.boundary), by_caps, 0.01 * by_caps);
  // The film draws the file's triangles and those that close the mouth.
  EXPECT_GT(wound.drawn.triangles.rows(), open.triangles.rows());
}

TEST(SolidSurface, SheetsThatShareNoEdgesAreWhatTheyWindAround) {
  Lines notes;
  const SolidSurface found = made(loose_box(nullptr), {}, notes);
  EXPECT_TRUE(is_closed_manifold(found.boundary));
  EXPECT_NEAR(volume(found.boundary), 8, 0.08);
  std::mt19937 shaker(3);
  const SolidSurface shaken = made(loose_box(&shaker), {}, notes);
  EXPECT_TRUE(is_closed_manifold(shaken.boundary));
  EXPECT_NEAR(volume(shaken.boundary), 8, 0.08);
  EXPECT_NEAR(volume(shaken.drawn), 8, 1e-9);  // the drawn triangles face outward too
  const TriMesh ball = test::sphere_surface(0.5, 20, 10);
  const SolidSurface both = made(test::together(loose_box(nullptr), test::moved(ball, Vec3(5, 0, 0))), {}, notes);
  EXPECT_NEAR(volume(both.boundary), 8 + volume(ball), 0.08);
}

TEST(SolidSurface, AnEdgeWithThreeTrianglesIsNoObstacleAndWallsInsideAreNotDrawn) {
  const TriMesh box = test::box_surface(Vec3(1, 1, 1));
  TriMesh walled = box;
  walled.triangles.conservativeResize(14, 3);
  walled.triangles.bottomRows(2) << 0, 1, 7, 0, 7, 6;  // across the inside
  Lines notes;
  const SolidSurface found = made(walled, {}, notes);
  EXPECT_TRUE(is_closed_manifold(found.boundary));
  EXPECT_NEAR(volume(found.boundary), 8, 0.08);
  EXPECT_NEAR(volume(found.drawn), 8, 1e-9);
  EXPECT_EQ(found.drawn.triangles.rows(), 12);
  ASSERT_EQ(notes.size(), 2u);
  expect_part(notes[0], "three triangles or more share an edge");
  expect_part(notes[1], "lies inside, and is not drawn");
}

TEST(SolidSurface, SheetsWithoutInsideAreRefusedUnlessTheyGetAThickness) {
  TriMesh sheet{Positions(4, 3), Triangles(2, 3)};
  sheet.points << 0, 0, 0, 2, 0, 0, 2, 0, 1, 0, 0, 1;
  sheet.triangles << 0, 1, 2, 0, 2, 3;
  expect_part(refusal_of(sheet, {}), "encloses no volume: thicken = 0.01");
  Lines notes;
  const SolidSurface found = made(sheet, {.thickness = 0.1}, notes);
  EXPECT_TRUE(is_closed_manifold(found.boundary));
  EXPECT_NEAR(volume(found.boundary), 0.2, 1e-12);
  EXPECT_EQ(notes, Lines{"1 sheet was made 0.1 thick"});
  // Three sheets that meet in one edge, of which no neighbour continues another, become three solids.
  TriMesh fan{Positions(5, 3), Triangles(3, 3)};
  fan.points << 0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0;
  fan.triangles << 0, 1, 2, 0, 1, 3, 0, 1, 4;
  EXPECT_TRUE(is_closed_manifold(made(fan, {.thickness = 0.1}, notes).boundary));
  EXPECT_EQ(notes, Lines{"3 sheets were made 0.1 thick"});
}

TEST(SolidSurface, AOneSidedBandGetsAThicknessToo) {
  constexpr int cells = 40;
  TriMesh band{Positions(2 * cells, 3), Triangles(2 * cells, 3)};
  for (int i = 0; i < cells; ++i) {
    const double s = 2 * std::numbers::pi * i / cells;
    for (const int side : {0, 1}) {
      const double v = 0.2 * (2 * side - 1), r = 1 + v * std::cos(s / 2);
      band.points.row(2 * i + side) << r * std::cos(s), v * std::sin(s / 2), r * std::sin(s);
    }
    const int a = 2 * i, b = a + 1, c = i + 1 < cells ? a + 2 : 1, d = i + 1 < cells ? a + 3 : 0;
    band.triangles.row(2 * i) << a, b, c;
    band.triangles.row(2 * i + 1) << b, d, c;
  }
  Lines notes;
  const SolidSurface found = made(band, {.thickness = 0.05}, notes);
  EXPECT_TRUE(is_closed_manifold(found.boundary));
  EXPECT_NEAR(volume(found.boundary), 0.4 * 2 * std::numbers::pi * 0.05, 0.01);
}

TEST(SolidSurface, TheNumberOfThreadsChangesNoBit) {
  const TriMesh mesh = loose_box(nullptr);
  Numbered surface{mesh, std::vector<Eigen::Index>(std::size_t(mesh.triangles.rows()), 0)};
  Threads one(1), three(3);
  const WindingSolid a = winding_solid(surface, "x", one), b = winding_solid(surface, "x", three);
  EXPECT_EQ(a.boundary.points, b.boundary.points);
  EXPECT_EQ(a.boundary.triangles, b.boundary.triangles);
  EXPECT_EQ(a.drawn.points, b.drawn.points);
}

TEST(SolidSurface, AxesAndUnitsAreThoseOfTheOptions) {
  const TriMesh box = test::moved(test::box_surface(Vec3(1, 2, 3)), Vec3(10, 20, 30));
  EXPECT_EQ(set_up(box, {}).points, box.points);
  const auto extent = [&](const SurfaceOptions& options) { return bounds_of(set_up(box, options).points).extent(); };
  EXPECT_TRUE(extent({.up = UpAxis::z}).isApprox(Vec3(2, 6, 4)));
  EXPECT_TRUE(extent({.up = UpAxis::x}).isApprox(Vec3(4, 2, 6)));
  EXPECT_TRUE(extent({.unit = LengthUnit::millimetre}).isApprox(Vec3(0.002, 0.004, 0.006)));
  EXPECT_TRUE(extent({.size = 3}).isApprox(Vec3(1, 2, 3)));
  // What was up in the file is up here, and right-handed axes stay so.
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z, UpAxis::minus_x, UpAxis::minus_y, UpAxis::minus_z}) {
    const TriMesh turned = set_up(box, {.up = up, .center = true});
    EXPECT_GT(volume(turned), 0);
    EXPECT_NEAR(bounds_of(turned.points).lower.y(), 0, 1e-12);
    EXPECT_NEAR(bounds_of(turned.points).center().x(), 0, 1e-12);
    const int axis = static_cast<int>(up) % 3;
    const double sign = static_cast<int>(up) < 3 ? 1 : -1;
    const Positions placed = set_up(box, {.up = up}).points;
    for (Eigen::Index i = 0; i < placed.rows(); ++i) EXPECT_EQ(placed(i, 1), sign * box.points(i, axis));
  }
}

TEST(TriangleSoup, TheWindingNumberIsThatOfASumOverAllTriangles) {
  const TriMesh open = bowl(0.2);
  const TriangleSoup soup(open);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-2, 2);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(place(random), place(random), place(random));
    double sum = 0;
    for (Eigen::Index t = 0; t < open.triangles.rows(); ++t) {
      Vec3 c[3];
      for (int k = 0; k < 3; ++k) c[k] = open.points.row(open.triangles(t, k)).transpose() - p;
      const double la = c[0].norm(), lb = c[1].norm(), lc = c[2].norm();
      sum += 2 * std::atan2(c[0].dot(c[1].cross(c[2])),
                            la * lb * lc + c[0].dot(c[1]) * lc + c[1].dot(c[2]) * la + c[2].dot(c[0]) * lb);
    }
    worst = std::max(worst, std::abs(soup.winding_number(p) - sum / (4 * std::numbers::pi)));
  }
  EXPECT_LT(worst, 0.03);
}

TEST(TriangleSoup, ManyPlacesHaveTheBitsOfEachAlone) {
  const TriangleSoup soup(bowl(0.2));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  std::vector<Vec3> places = {soup.mesh().points.row(0), soup.mesh().points.row(9)};
  while (places.size() < 200) places.emplace_back(place(random), place(random), place(random));
  std::vector<double> windings;
  soup.winding_numbers(places, windings);
  ASSERT_EQ(windings.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(windings[i], soup.winding_number(places[i])) << i;
}

TEST(TriangleSoup, RaysAndNearestPointsAreThoseOfTheSphere) {
  const TriangleSoup soup(test::sphere_surface(1, 120, 80));
  EXPECT_NEAR(soup.first_hit(Vec3(0.1, 0.05, 0), Vec3(0, 0, 1), -1).value_or(0), std::sqrt(1 - 0.0125), 2e-3);
  EXPECT_NEAR(soup.first_hit(Vec3(0.1, 0.05, 3), Vec3(0, 0, -1), -1).value_or(0), 3 - std::sqrt(1 - 0.0125), 2e-3);
  EXPECT_FALSE(soup.first_hit(Vec3(0.1, 0.05, 3), Vec3(0, 0, 1), -1));
  const auto near = soup.closest(Vec3(0, 0, 1.5), 1, Vec3(0, 0, 1));
  EXPECT_NEAR(std::sqrt(near.squared), 0.5, 2e-3);
  EXPECT_EQ(soup.closest(Vec3(0, 0, 1.5), 1, Vec3(0, 0, -1)).triangle, -1);  // only the far side faces that way
  EXPECT_EQ(soup.closest(Vec3(0, 0, 1.5), 0.4, Vec3(0, 0, 0)).triangle, -1);
}

}  // namespace solid_surface_test
}  // namespace supple
