// Tests solids whose vertices have moved against new solids of the same triangles, and how places near a surface are
// carried along.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/solids/surface_move.h"
#include "geometry/solids/surface_point.h"
#include "geometry/solids/triangle_solid.h"
#include "support/surfaces.h"

namespace supple {
namespace moved_solid_test {

Positions bent(Positions points) {
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const double angle = 0.8 * points(v, 0);
    const double y = points(v, 1), z = points(v, 2);
    points.row(v) << points(v, 0) * 1.3, std::cos(angle) * y - std::sin(angle) * z,
        std::sin(angle) * y + std::cos(angle) * z;
  }
  return points;
}

TEST(MovedSolid, AnswersAreThoseOfANewSolid) {
  const TriMesh torus = test::torus_surface(1, 0.3, 40, 20);
  const TriangleSolid rest(torus), fresh({bent(torus.points), torus.triangles});
  const auto moved = rest.moved(bent(torus.points));
  EXPECT_EQ(moved->usual_half_thickness(), rest.usual_half_thickness());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-1.8, 1.8);
  QueryMemory near;
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p(at(random), 0.4 * at(random), at(random));
    const SurfacePoint wanted = fresh.closest(p), found = moved->closest(p), remembered = moved->closest(p, near);
    EXPECT_NEAR(found.distance, wanted.distance, 1e-12);
    EXPECT_NEAR(remembered.distance, wanted.distance, 1e-12);
    EXPECT_NEAR(moved->winding_number(p), fresh.winding_number(p), 0.1);
    const Vec3 to(at(random), at(random), at(random));
    const auto entry = moved->entry(p, to), entry_wanted = fresh.entry(p, to);
    ASSERT_EQ(entry.has_value(), entry_wanted.has_value());
    if (entry) {
      EXPECT_NEAR(*entry, *entry_wanted, 1e-12);
    }
    inside += wanted.distance < 0;
  }
  EXPECT_GT(inside, 100);
}

// Two balls that are apart at rest lie in one another after the move, and are one solid then.
TEST(MovedSolid, PartsThatComeIntoEachOtherFormAUnion) {
  TriMesh balls = test::sphere_surface(0.5, 16, 8);
  const Eigen::Index points = balls.points.rows(), triangles = balls.triangles.rows();
  balls.points.conservativeResize(2 * points, 3);
  balls.triangles.conservativeResize(2 * triangles, 3);
  balls.points.bottomRows(points) = balls.points.topRows(points).rowwise() + Eigen::RowVector3d(2, 0, 0);
  balls.triangles.bottomRows(triangles) = balls.triangles.topRows(triangles).array() + std::int32_t(points);
  Positions together = balls.points;
  together.bottomRows(points).rowwise() -= Eigen::RowVector3d(1.4, 0, 0);
  const auto moved = TriangleSolid(balls).moved(together);
  QueryMemory near;
  EXPECT_LT(moved->closest(Vec3(0.45, 0, 0), near).distance, 0);
  EXPECT_LT(moved->closest(Vec3(0.3, 0.1, 0), near).distance, 0);
  EXPECT_GT(moved->closest(Vec3(0.3, 0.6, 0), near).distance, 0);
}

// Under a rigid motion every place near the surface moves as the solid does; far away it stays.
TEST(SurfaceMove, PlacesNearTheSurfaceGoWithItAndKeepTheirDistance) {
  const TriMesh torus = test::torus_surface(1, 0.3, 40, 20);
  const auto start = std::make_shared<TriangleSolid>(torus);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(Vec3(0.01, 0.02, 0)).rotate(Eigen::AngleAxisd(0.02, Vec3::UnitX()));
  const Positions there = (torus.points * motion.linear().transpose()).rowwise() + motion.translation().transpose();
  const SurfaceMove move(start, start->moved(there), 0.1);
  ASSERT_TRUE(move.moves());
  for (const Vec3& p : {Vec3(1.35, 0, 0), Vec3(0, 0.32, 1), Vec3(0.9, -0.1, 0.6), Vec3(1.2, 0, 0)}) {
    EXPECT_LT((move.carried(p) - motion * p).norm(), 1e-12) << p.transpose();
    EXPECT_LE((move.carried(p) - p).norm(), move.most_carried());
  }
  EXPECT_EQ(move.carried(Vec3(5, 0, 0)), Vec3(5, 0, 0));
  EXPECT_LT((move.motion_near(Vec3(1.4, 0, 0)).matrix() - motion.matrix()).norm(), 1e-12);
  const SurfaceMove still(start, start, 0.1);
  EXPECT_FALSE(still.moves());
  EXPECT_EQ(still.carried(Vec3(1.3, 0.1, 0)), Vec3(1.3, 0.1, 0));
}

}  // namespace moved_solid_test
}  // namespace supple
