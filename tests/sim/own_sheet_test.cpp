// Tests whether a sheet is found to touch itself: a strip that is rolled up until its end lies on its beginning.
#include "sim/contact/own_sheet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/meshes/cloth.h"

namespace supple {
namespace own_sheet_test {

constexpr double radius = 0.2, beyond = 0.6, turns = 2 * 3.14159265358979 + beyond;

// Holds a strip, and what is known of it.
struct Strip {
  ClothMesh cloth = cloth_grid({turns * radius, 0.15}, {40, 4});
  Triangles triangles = cloth.surface.triangles;
  MovingSurface moving{triangles, cloth.surface.points};
  OwnSheet own{moving, cloth.surface.points};

  // Returns the strip rolled up, with so much room between its beginning and its end, which lies outside [m].
  Positions rolled(double gap) const {
    Positions x = cloth.surface.points;
    const Bounds box = bounds_of(x);
    for (auto row : x.rowwise()) {
      const double angle = (row[0] - box.lower[0]) / radius, out = radius + gap * angle / (turns - beyond);
      row = Eigen::RowVector3d(-out * std::cos(angle), out * std::sin(angle), row[1]);
    }
    return x;
  }
  void move(const Positions& q, const Positions& x) {
    moving.set_start(q);
    moving.set_end(x);
  }
  bool touches(const Positions& q, const Positions& x) {
    move(q, x);
    return own.touches(moving, q, x, (x - q).colwise().mean().transpose());
  }
  bool crosses(const Positions& q) {
    move(q, q);
    return own.crossing(moving, q).has_value();
  }
  OwnSheet::Pairs pairs(const Positions& q, const Positions& x, double margin) {
    move(q, x);
    OwnSheet::Pairs found;
    own.find_pairs(moving, q, x, margin, (x - q).colwise().mean().transpose(), found);
    return found;
  }
};

TEST(OwnSheet, IsNotTouchedWhereItOnlyBends) {
  Strip strip;
  EXPECT_FALSE(strip.touches(strip.cloth.surface.points, strip.cloth.surface.points));
  EXPECT_FALSE(strip.touches(strip.rolled(0.03), strip.rolled(0.02)));
  Positions away = strip.rolled(0.02);
  away.rowwise() += Eigen::RowVector3d(3, -2, 1);
  EXPECT_FALSE(strip.touches(strip.rolled(0.03), away)) << "a common motion is none";
}

TEST(OwnSheet, IsTouchedWhereItComesThroughItselfFromEitherSide) {
  Strip strip;
  EXPECT_TRUE(strip.touches(strip.rolled(0.03), strip.rolled(-0.03)));
  EXPECT_TRUE(strip.touches(strip.rolled(-0.03), strip.rolled(0.03)));
}

TEST(OwnSheet, IsTouchedWhereItBeginsInItsLayer) {
  Strip strip;
  EXPECT_TRUE(strip.touches(strip.rolled(0.4 * strip.own.layer()), strip.rolled(0.03)));
  EXPECT_FALSE(strip.touches(strip.rolled(2 * strip.own.layer()), strip.rolled(0.03)));
}

TEST(OwnSheet, CrossesItselfWhereOneEndIsTiltedThroughTheOther) {
  Strip strip;
  Positions x = strip.rolled(0.01);
  EXPECT_FALSE(strip.crosses(x));
  EXPECT_FALSE(strip.crosses(strip.cloth.surface.points));
  const Bounds box = bounds_of(strip.cloth.surface.points);
  for (Eigen::Index v = 0; v < x.rows(); ++v)
    if (strip.cloth.surface.points(v, 0) > box.upper[0] - 0.5 * beyond * radius)
      x.row(v).head<2>() *= 1 - 1.5 * (strip.cloth.surface.points(v, 1) - box.lower[1]);
  EXPECT_TRUE(strip.crosses(x));
}

// Two ends of a strip that are rolled onto each other, in its layer, are neighbours where a seam holds them.
TEST(OwnSheet, IsNotTouchedWhereASeamHoldsItTogether) {
  const ClothMesh cloth = cloth_grid({2 * 3.14159265358979 * radius, 0.15}, {40, 4});
  const MovingSurface moving(cloth.surface.triangles, cloth.surface.points);
  std::vector<JoinedVertices> sewn;
  for (int row = 0; row < 5; ++row) sewn.emplace_back(41 * row, 41 * row + 40);
  const OwnSheet open(moving, cloth.surface.points), closed(moving, cloth.surface.points, sewn);
  Positions x = cloth.surface.points;
  for (auto row : x.rowwise()) {
    const double angle = (row[0] - cloth.surface.points.col(0).minCoeff()) * 1.005 / radius;
    row = Eigen::RowVector3d(-radius * std::cos(angle), radius * std::sin(angle), row[1]);
  }
  MovingSurface moved = moving;
  moved.set_end(x);
  moved.set_start(x);
  EXPECT_TRUE(open.overlaps(moved, x));
  EXPECT_FALSE(closed.overlaps(moved, x));
}

// Distances by brute force, where nothing moves: no pair may be missed, and none is near in the mesh.
TEST(OwnSheet, FindsAllPairsThatAreNear) {
  Strip strip;
  const double margin = 0.012;
  const Positions x = strip.rolled(0.01);
  const OwnSheet::Pairs pairs = strip.pairs(x, x, margin);
  EXPECT_GT(pairs.points.size(), 50u);
  EXPECT_GT(pairs.edges.size(), 50u);
  const double away = 4 * radius * turns / 40;  // along the strip, between what may touch [m]
  std::size_t over = 0;
  for (std::int32_t v = 0; v < x.rows(); ++v) {
    for (std::int32_t t = 0; t < strip.triangles.rows(); ++t) {
      std::array<Vec3, 3> corners;
      double along = 1e300;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t c = strip.triangles(t, k);
        corners[std::size_t(k)] = x.row(c);
        along = std::min(along, std::abs(strip.cloth.surface.points(c, 0) - strip.cloth.surface.points(v, 0)));
      }
      const auto place = OwnSheet::over(corners, x.row(v));
      if (!place || std::abs(place->above) > margin || along < away) continue;
      ++over;
      const auto is_this = [&](const OwnSheet::PointPair& pair) { return pair.vertex == v && pair.triangle == t; };
      EXPECT_TRUE(std::ranges::any_of(pairs.points, is_this)) << v << " " << t;
    }
  }
  EXPECT_GT(over, 30u);
  for (const auto& [v, t, volume] : pairs.points)
    EXPECT_GT(std::abs(strip.cloth.surface.points(v, 0) - strip.cloth.surface.points(strip.triangles(t, 0), 0)), away);
}

// While it falls by a metre, the strip comes nearer to itself by 2 cm: what is 3 cm away may come as near as 1 cm.
TEST(OwnSheet, FindsPairsByTheirMotionBesideEachOther) {
  Strip strip;
  Positions x = strip.rolled(0.01);
  x.rowwise() += Eigen::RowVector3d(0, -1, 0);
  EXPECT_GT(strip.pairs(strip.rolled(0.03), x, 0.012).size(), 50u);
  Positions same = strip.rolled(0.03);
  same.rowwise() += Eigen::RowVector3d(0, -1, 0);
  EXPECT_EQ(strip.pairs(strip.rolled(0.03), same, 0.012).size(), 0u);
}

}  // namespace own_sheet_test
}  // namespace supple
