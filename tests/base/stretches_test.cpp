#include "base/stretches.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

namespace supple {
namespace {

Mat3 turn_of(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
}

TEST(SignedSvd, GivesBackAMatrixAndItsRotation) {
  const Mat3 stretches[] = {Vec3(2.5, 1.0, 0.4).asDiagonal(), Vec3(1.2, 0.9, -0.3).asDiagonal(),
                            Vec3(-2, -1.5, -0.1).asDiagonal()};
  const Mat3 first = turn_of(70, {1, 2, -1}), second = turn_of(-130, {0.3, -1, 1});
  for (const Mat3& stretch : stretches) {
    const Mat3 f = first * stretch * second;
    const SignedSvd svd(f);
    EXPECT_LT((svd.u * svd.stretch.asDiagonal() * svd.v.transpose() - f).norm(), 1e-13);
    EXPECT_LT((svd.rotation().transpose() * svd.rotation() - Mat3::Identity()).norm(), 1e-13);
    EXPECT_NEAR(svd.rotation().determinant(), 1, 1e-13);
    EXPECT_GE(svd.stretch[0], svd.stretch[1]);
    EXPECT_GE(svd.stretch[1], std::abs(svd.stretch[2]));
    EXPECT_EQ(svd.stretch[2] < 0, f.determinant() < 0);
  }
}

TEST(SignedSvd, KnowsTheStretchesOfAMatrixThatMirrors) {
  const Mat3 f = turn_of(40, {1, 0, 2}) * Mat3(Vec3(1.2, 0.9, -0.3).asDiagonal());
  EXPECT_LT((SignedSvd(f).stretch - Vec3(1.2, 0.9, -0.3)).norm(), 1e-13);
}

TEST(NearestRotation, TakesPointsBackToWhereTheyWere) {
  const Mat3 turn = turn_of(155, {-1, 0.5, 0.2});
  const std::vector<Vec3> points = {{1, 0, 0.2}, {-0.4, 2, 0}, {0.3, -1, 1}, {-0.9, -1, -1.2}};  // their mean is 0
  Mat3 moments = Mat3::Zero();
  for (const Vec3& p : points) moments += turn * p * p.transpose();
  EXPECT_LT((nearest_rotation(moments) - turn).norm(), 1e-13);
}

TEST(NearestRotation, IsNearerThanItsNeighbours) {
  Mat3 f;
  f << 0.7, -1.2, 0.3, 0.9, 0.4, -0.8, -0.2, 1.1, -0.6;
  ASSERT_LT(f.determinant(), 0);
  const Mat3 nearest = nearest_rotation(f);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1)}) {
    for (const double degrees : {-90.0, -1.0, 1.0, 90.0})
      EXPECT_GT((turn_of(degrees, axis) * nearest - f).norm(), (nearest - f).norm()) << degrees;
  }
}

TEST(SignedSvd, OfWhatIsNotFiniteIsNotANumber) {
  for (const double entry : {std::nan(""), infinity}) {
    Mat3 f = Mat3::Identity();
    f(1, 2) = entry;
    const SignedSvd svd(f);
    EXPECT_TRUE(svd.u.array().isNaN().all());
    EXPECT_TRUE(svd.v.array().isNaN().all());
    EXPECT_TRUE(svd.stretch.array().isNaN().all());
  }
}

TEST(NearestRotation, IsARotationWhereSeveralAreNearest) {
  for (const Mat3& f : {Mat3(Mat3::Zero()), Mat3(-Mat3::Identity())}) {
    const Mat3 nearest = nearest_rotation(f);
    EXPECT_LT((nearest.transpose() * nearest - Mat3::Identity()).norm(), 1e-13);
    EXPECT_NEAR(nearest.determinant(), 1, 1e-13);
  }
}

// Points in a line leave the turn about the line open.
TEST(NearestRotation, OfPointsInALineIsARotation) {
  const Vec3 along(1, 2, 2);
  const Mat3 turn = turn_of(60, {0, 0, 1});
  const Mat3 nearest = nearest_rotation(turn * along * along.transpose());
  EXPECT_LT((nearest * along - turn * along).norm(), 1e-12);
  EXPECT_NEAR(nearest.determinant(), 1, 1e-13);
}

// Measures a piece that is stretched in two directions of its plane, at an angle to its edges, and turned in space.
std::array<double, 2> stretches_of_piece(double along, double across) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.6).toRotationMatrix();
  const Eigen::Matrix2d in_plane = turn * Eigen::Vector2d(along, across).asDiagonal() * turn.transpose();
  const Eigen::Matrix<double, 3, 2> f = turn_of(50, {1, -1, 3}).leftCols<2>() * in_plane;
  return flat_stretches(f.transpose() * f);
}

TEST(FlatStretches, AreThoseOfThePiece) {
  EXPECT_NEAR(stretches_of_piece(2, 0.5)[0], 2, 1e-14);
  EXPECT_NEAR(stretches_of_piece(2, 0.5)[1], 0.5, 1e-14);
  EXPECT_NEAR(stretches_of_piece(0.7, 1.4)[0], 1.4, 1e-14);
  EXPECT_NEAR(stretches_of_piece(3, 0)[1], 0, 1e-7);
}

// The difference of the squared stretches is round-off here, and the stretches have all digits nevertheless.
TEST(FlatStretches, AreExactWhereBothAreEqual) {
  for (const double both : {1.0, 0.8}) {
    EXPECT_NEAR(stretches_of_piece(both, both)[0], both, 1e-14);
    EXPECT_NEAR(stretches_of_piece(both, both)[1], both, 1e-14);
  }
}

TEST(FlatStretches, AreUnknownWhereANumberIsNotFinite) {
  Eigen::Matrix2d squares = Eigen::Matrix2d::Identity();
  squares(0, 1) = std::nan("");
  EXPECT_TRUE(std::isnan(flat_stretches(squares)[0]));
  EXPECT_TRUE(std::isnan(flat_stretches(squares)[1]));
}

}  // namespace
}  // namespace supple
