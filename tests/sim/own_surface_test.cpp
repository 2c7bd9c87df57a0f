// Tests whether a solid is found to touch itself: a bar that is rolled up until its end lies on its beginning.
#include "sim/contact/own_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/meshes/mesh.h"
#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {
namespace own_surface_test {

constexpr double radius = 0.2, thickness = 0.1, turns = 2 * 3.14159265358979 + 0.6;

// Holds a bar, and what is known of its surface.
struct Bar {
  TetMesh mesh = box_mesh(Vec3(turns * radius, thickness, thickness), {40, 3, 3});
  Triangles triangles = boundary_faces(mesh.tets);
  MovingSurface moving{triangles, mesh.rest};
  OwnSurface own{mesh.tets, moving, mesh.rest, bounds_of(mesh.rest).diagonal()};

  // Tells whether a corner of a triangle is in one element with a vertex.
  bool share_element(std::int32_t vertex, std::int32_t triangle) const {
    for (const auto tet : mesh.tets.rowwise())
      for (int k = 0; k < 3; ++k)
        if ((tet.array() == vertex).any() && (tet.array() == triangles(triangle, k)).any()) return true;
    return false;
  }

  // Returns the bar rolled up, with so much room between its beginning and its end, which lies outside [m].
  Positions rolled(double gap) const {
    Positions x = mesh.rest;
    const Bounds box = bounds_of(mesh.rest);
    for (auto row : x.rowwise()) {
      const double angle = (row[0] - box.lower[0]) / radius;
      const double out = radius + (row[1] - box.center()[1]) + (thickness + gap) * angle / (turns - 0.6);
      row = Eigen::RowVector3d(-out * std::cos(angle), out * std::sin(angle), row[2]);
    }
    return x;
  }
  bool touches(const Positions& q, const Positions& x) {
    return own.touches(moving, q, x, (x - q).colwise().mean().transpose());
  }
};

TEST(OwnSurface, IsNotTouchedByABodyThatOnlyBends) {
  Bar bar;
  EXPECT_FALSE(bar.touches(bar.mesh.rest, bar.mesh.rest));
  EXPECT_FALSE(bar.touches(bar.rolled(0.03), bar.rolled(0.01)));
  Positions away = bar.rolled(0.01);
  away.rowwise() += Eigen::RowVector3d(3, -2, 1);
  EXPECT_FALSE(bar.touches(bar.rolled(0.01), away)) << "a common motion is none";
}

TEST(OwnSurface, IsTouchedWhereAPartComesThroughAnother) {
  Bar bar;
  EXPECT_TRUE(bar.touches(bar.rolled(0.01), bar.rolled(-0.003)));
  EXPECT_TRUE(bar.touches(bar.rolled(0.03), bar.rolled(-0.03))) << "even if it is as deep as would not be found inside";
  EXPECT_FALSE(bar.own.overlaps(bar.moving, bar.rolled(0.03))) << "only the way tells";
}

TEST(OwnSurface, HasAroundAPointInsideTheNearestPlaceOfTheOtherPart) {
  Bar bar;
  const double depth = 0.004;
  const Positions q = bar.rolled(-depth);
  EXPECT_TRUE(bar.own.overlaps(bar.moving, q));
  bar.moving.set_start(q);
  OwnSurface::Pairs pairs;
  bar.own.find_pairs(bar.moving, q, q, 0, Vec3::Zero(), pairs);
  int inside = 0;
  for (std::size_t i = 0; i < pairs.vertices.size(); ++i) {
    for (const std::int32_t t : pairs.of(i)) EXPECT_FALSE(bar.share_element(pairs.vertices[i], t));
    const auto place = bar.own.place_around(bar.moving, q, pairs.vertices[i], pairs.of(i));
    if (!place) continue;
    ++inside;
    EXPECT_LT(place->distance, 0);
    EXPECT_GT(place->distance, -1.5 * depth);
    EXPECT_NEAR((place->point - q.row(pairs.vertices[i]).transpose()).norm(), -place->distance, 1e-12);
  }
  EXPECT_GT(inside, 10);
}

TEST(OwnSurface, IsNotAskedForInABodyThatIsTangled) {
  Bar bar;
  Positions q = bar.rolled(0.01), x = bar.rolled(-0.003);
  const Eigen::Index middle = q.rows() / 2;
  for (Eigen::Index v = middle; v < middle + 12; ++v) q.row(v) *= 0.2;
  EXPECT_FALSE(bar.touches(q, x));
}

}  // namespace own_surface_test
}  // namespace supple
