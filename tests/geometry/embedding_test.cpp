// Tests how a skin follows the elements below it: exactly where it can, and boundedly where elements fail.
#include "geometry/skins/embedding.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "geometry/meshes/boundary_walk.h"
#include "geometry/skins/skin_stretch.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "support/surfaces.h"

namespace supple {
namespace embedding_test {

Shape shape_of(const Primitive& primitive) {
  Shape shape;
  ShapePart part;
  part.primitive = primitive;
  shape.root.parts.push_back(part);
  return shape;
}

// Makes a body of a sphere with so few vertices that most of its skin lies outside.
struct CoarseBall {
  TriMesh skin = test::sphere_surface(1, 60, 40);
  TetMesh mesh = tetrahedralize(shape_of(Sphere{1}), 100, "ball");
};

TEST(Embedding, FollowsARigidMotionExactlyAtAnyScale) {
  const CoarseBall ball;
  Embedding embedding = embed(ball.skin, ball.mesh);
  const OutsideShare outside = outside_share(embedding);
  EXPECT_GT(outside.share, 0.5);
  EXPECT_GT(outside.furthest, 0.05);
  const Mat3 turn = 2.5 * Eigen::AngleAxisd(2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto placed = [&turn](const Positions& at) {
    return Positions((at * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -1, 7));
  };
  scale_lengths(embedding, 2.5);
  EXPECT_LT((embedded_points(embedding, placed(ball.mesh.rest)) - placed(ball.skin.points)).norm(), 1e-11);
}

TEST(Embedding, KeepsABarycentricPlaceInsideElements) {
  const CoarseBall ball;
  const TriMesh within{0.6 * ball.skin.points, ball.skin.triangles};
  const Embedding embedding = embed(within, ball.mesh);
  EXPECT_EQ(outside_share(embedding).share, 0);
  EXPECT_EQ(embedding.frames.count(), 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  Positions now = ball.mesh.rest;
  for (double& value : now.reshaped()) value += any(random);
  const Positions found = embedded_points(embedding, now);
  for (Eigen::Index v = 0; v < found.rows(); ++v) {
    EXPECT_GE(embedding.weights.row(v).minCoeff(), -1e-9);
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 4; ++k) sum += embedding.weights(v, k) * now.row(embedding.corners(v, k)).transpose();
    EXPECT_EQ(Vec3(found.row(v)), sum);
  }
}

TEST(Embedding, StaysNearWhatCarriesItWhateverElementsDo) {
  const CoarseBall ball;
  const Embedding embedding = embed(ball.skin, ball.mesh);
  const auto furthest_off = [&](const Positions& now) {
    const Positions found = embedded_points(embedding, now);
    EXPECT_TRUE(found.allFinite());
    double most = 0;
    for (Eigen::Index v = 0; v < found.rows(); ++v) {
      const double nearest = (now.rowwise() - found.row(v)).rowwise().norm().minCoeff();
      most = std::max(most, embedding.outside(v) ? nearest : 0);
    }
    return most;
  };
  // Collapsed to a point, no point is further off than 1.5 times its offset.
  EXPECT_LE(furthest_off(Positions::Zero(ball.mesh.rest.rows(), 3)), 1.5 * outside_share(embedding).furthest + 1e-12);
  Positions flat = ball.mesh.rest, mirrored = ball.mesh.rest;
  flat.col(1).setZero();
  mirrored.col(0) *= -1;
  EXPECT_LT(furthest_off(flat), 1);
  EXPECT_LT(furthest_off(mirrored), 1);
}

// A vertex of the mesh that moves alone makes a hill with a round top, whatever the skin's distance from it at rest. A
// pointed one would show as a spike in a stripe of colour.
TEST(Embedding, MakesNoSpikeOfAVertexThatMovesAlone) {
  CoarseBall ball;
  ball.skin = test::sphere_surface(1, 120, 80);
  const Embedding embedding = embed(ball.skin, ball.mesh);
  double sharpest = 0, highest = 0;
  for (Eigen::Index moved = 0; moved < ball.mesh.rest.rows(); ++moved) {
    const Vec3 place = ball.mesh.rest.row(moved);
    if (place.norm() < 0.95 || std::abs(place.y()) > 0.7) continue;
    Positions now = ball.mesh.rest;
    now.row(moved) += Eigen::RowVector3d(0, 1, 0);
    const Positions way = embedded_points(embedding, now) - ball.skin.points;
    Positions around = Positions::Zero(way.rows(), 3);
    std::vector<int> number(std::size_t(way.rows()), 0);
    for (Eigen::Index t = 0; t < ball.skin.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t from = ball.skin.triangles(t, k), to = ball.skin.triangles(t, (k + 1) % 3);
        around.row(from) += way.row(to);
        ++number[std::size_t(from)];
      }
    }
    for (Eigen::Index v = 0; v < way.rows(); ++v) {
      if (number[std::size_t(v)] < 6) continue;  // on the sphere's seam
      sharpest = std::max(sharpest, std::abs(way(v, 1) - around(v, 1) / number[std::size_t(v)]));
      highest = std::max(highest, way(v, 1));
    }
  }
  EXPECT_GT(highest, 0.6) << "there is no hill";
  EXPECT_LT(sharpest, 0.06) << "of a hill of " << highest;
}

TEST(Embedding, JoinsPartsAlongTheSkinAndNotAcrossAGap) {
  // Two blocks of elements, and two skins that reach through the gap into the other block's elements.
  const TetMesh left = tetrahedralize(shape_of(Box{Vec3(0.5, 0.5, 0.5), 0}), 300, "box");
  TetMesh both = left;
  const Eigen::Index n = left.rest.rows();
  both.rest.conservativeResize(2 * n, 3);
  both.rest.bottomRows(n) = left.rest.rowwise() + Eigen::RowVector3d(1.01, 0, 0);
  both.tets.conservativeResize(2 * left.tets.rows(), 4);
  both.tets.bottomRows(left.tets.rows()) = left.tets.array() + std::int32_t(n);
  TriMesh ball = test::sphere_surface(0.53, 60, 40);
  // A sphere is pressed into a rounded cube, whose sides lie a little outside the elements.
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v) {
    const Vec3 at = ball.points.row(v);
    const Vec3 powers = at.array().square().square();
    ball.points.row(v) *= 0.53 / std::pow(powers.array().square().sum(), 0.125);
  }
  const TriMesh skin = test::together(ball, test::moved(ball, Vec3(1.01, 0, 0)));
  const Embedding embedding = embed(skin, both);
  Positions now = both.rest;
  now.bottomRows(n).rowwise() += Eigen::RowVector3d(0.3, 2, 0);
  Positions expected = skin.points;
  expected.bottomRows(ball.points.rows()).rowwise() += Eigen::RowVector3d(0.3, 2, 0);
  EXPECT_LT((embedded_points(embedding, now) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

// The new points lie in the middle of edges, moved out onto the sphere, and between two of themselves.
TEST(Embedding, CarriesPointsThatComeInTheMiddleOfTwo) {
  const CoarseBall ball;
  const Embedding before = embed(ball.skin, ball.mesh);
  Positions points = ball.skin.points;
  std::vector<std::array<std::int32_t, 2>> ends;
  const auto append = [&](std::int32_t a, std::int32_t b) {
    ends.push_back({a, b});
    points.conservativeResize(points.rows() + 1, 3);
    points.row(points.rows() - 1) = (points.row(a) + points.row(b)).normalized();
  };
  for (Eigen::Index t = 0; t < ball.skin.triangles.rows(); t += 7)
    append(ball.skin.triangles(t, 0), ball.skin.triangles(t, 1));
  append(static_cast<std::int32_t>(points.rows() - 1), ball.skin.triangles(0, 0));
  const Embedding after = with_middles(before, points, ends, ball.mesh);
  ASSERT_EQ(after.points(), points.rows());
  const Mat3 turn = Eigen::AngleAxisd(2, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  EXPECT_LT((embedded_points(after, ball.mesh.rest * turn.transpose()) - points * turn.transpose()).norm(), 1e-11);
  // In a bent ball, the old points are where they were, and new ones between their ends.
  Positions bent = ball.mesh.rest;
  for (Eigen::Index v = 0; v < bent.rows(); ++v) bent(v, 0) += 0.3 * bent(v, 1) * bent(v, 1);
  const Positions old = embedded_points(before, bent), now = embedded_points(after, bent);
  EXPECT_LT((now.topRows(old.rows()) - old).norm(), 1e-11);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const Vec3 a = now.row(ends[i][0]), b = now.row(ends[i][1]), middle = now.row(old.rows() + Eigen::Index(i));
    EXPECT_LT((middle - 0.5 * (a + b)).norm(), 0.5 * (a - b).norm() + 1e-3);
  }
}

TEST(Embedding, KeepsTheNamedPointsAlone) {
  const CoarseBall ball;
  const Embedding whole = embed(ball.skin, ball.mesh);
  Embedding part = whole;
  std::vector<std::int32_t> kept;
  for (std::int32_t v = 1; v < ball.skin.points.rows(); v += 3) kept.push_back(v);
  keep_points(part, kept);
  Positions now = ball.mesh.rest;
  now.col(1) *= 0.8;
  const Positions all = embedded_points(whole, now), some = embedded_points(part, now);
  ASSERT_EQ(some.rows(), Eigen::Index(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(some.row(Eigen::Index(i)), all.row(kept[i]));
}

TEST(VertexFrames, AreHeldWithinTheirLimitsAndNeverReflect) {
  std::mt19937 random(2);
  std::normal_distribution<double> any(0, 1);
  for (int i = 0; i < 1000; ++i) {
    Mat3 gradient;
    for (double& value : gradient.reshaped()) value = any(random);
    const Mat3 held = held_within_limits(gradient);
    const Vec3 stretch = held.jacobiSvd().singularValues();
    EXPECT_LE(stretch[0], 1.5 + 1e-12);
    EXPECT_GE(stretch[2], 2.0 / 3 - 1e-12);
    EXPECT_GT(held.determinant(), 0);
  }
  const Mat3 turn = Eigen::AngleAxisd(1, Vec3::UnitX()).toRotationMatrix();
  const Mat3 moderate = turn * Vec3(1.2, 1, 0.8).asDiagonal();
  EXPECT_EQ(held_within_limits(moderate), moderate);
  EXPECT_LT(
      (held_within_limits(turn * Vec3(3, 1, 0.1).asDiagonal()) - turn * Vec3(1.5, 1, 2.0 / 3).asDiagonal()).norm(),
      1e-12);
  EXPECT_TRUE(held_within_limits(Mat3::Zero()).allFinite());
}

TEST(BoundaryWalk, FindsTheClosestPointOfATriangle) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto point = [&] { return Vec3(any(random), any(random), any(random)); };
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = point(), b = point(), c = point(), p = 2 * point();
    const Vec3 weights = closest_weights(a, b, c, p);
    EXPECT_GE(weights.minCoeff(), 0);
    EXPECT_NEAR(weights.sum(), 1, 1e-12);
    const double found = (weights[0] * a + weights[1] * b + weights[2] * c - p).norm();
    for (int s = 0; s <= 20; ++s) {
      for (int t = 0; s + t <= 20; ++t)
        EXPECT_LE(found, ((20 - s - t) / 20.0 * a + s / 20.0 * b + t / 20.0 * c - p).norm() + 1e-12);
    }
  }
}

TEST(SkinStretch, IsThatOfTheLongestEdgeAndOfTheElements) {
  const CoarseBall ball;
  Positions longer = ball.skin.points, mesh = ball.mesh.rest;
  longer.col(1) *= 3;
  mesh.col(1) *= 3;
  const StretchedEdge most = most_stretched_edge(ball.skin, longer, 0);
  EXPECT_NEAR(most.factor, 3, 0.01);
  EXPECT_NEAR((longer.row(most.from) - longer.row(most.to)).norm(),
              most.factor * (ball.skin.points.row(most.from) - ball.skin.points.row(most.to)).norm(), 1e-12);
  EXPECT_NEAR(largest_element_stretch(ball.mesh, mesh), 3, 1e-9);
  EXPECT_EQ(most_stretched_edge(ball.skin, longer, 10).from, -1);
}

}  // namespace embedding_test
}  // namespace supple
