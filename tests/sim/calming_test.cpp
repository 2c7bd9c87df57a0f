#include "sim/solver/calming.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/bodies.h"

namespace supple {
namespace calming_test {

struct Motion {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // momentum, about the origin [kg m/s], [kg m^2/s]
  double kinetic = 0;                                  // [J]
};

Motion motion_of(const Model& model, const Positions& x, const Positions& v) {
  Motion motion;
  for (int i = 0; i < model.free; ++i) {
    const Vec3 place = x.row(i), velocity = v.row(i);
    motion.linear += model.mass[i] * velocity;
    motion.angular += model.mass[i] * place.cross(velocity);
    motion.kinetic += 0.5 * model.mass[i] * velocity.squaredNorm();
  }
  return motion;
}

// Returns velocities that are no rigid motion and no deformation that is even.
Positions some_velocities(const Positions& x) {
  Positions v(x.rows(), 3);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Vec3 p = x.row(i);
    v.row(i) = Vec3(1 + std::sin(9 * p.y()) - 3 * p.y(), 2 * p.x() + std::cos(7 * p.z()), p.x() * p.y()).transpose();
  }
  return v;
}

Model free_bar() { return build_model(test::bar(Polynomial{1e4}, test::Held::nothing)); }

TEST(Calming, KeepsBothMomentaAndTakesOnlyEnergyOfDeformation) {
  const Model model = free_bar();
  const Positions x = model.rest, start = some_velocities(x);
  const Motion before = motion_of(model, x, start);
  Positions half = start, still = start;
  calm(model, 0.5, x, half);
  calm(model, 0, x, still);
  for (const Positions& v : {half, still}) {
    const Motion after = motion_of(model, x, v);
    EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm());
    EXPECT_LT((after.angular - before.angular).norm(), 1e-12 * before.angular.norm());
  }
  // The two parts of the motion are orthogonal, so that the energy of deformation goes with the square of what is kept.
  const double rigid = motion_of(model, x, still).kinetic;
  EXPECT_GT(before.kinetic, 1.02 * rigid);
  EXPECT_NEAR(motion_of(model, x, half).kinetic - rigid, 0.25 * (before.kinetic - rigid), 1e-12 * before.kinetic);
}

TEST(Calming, LeavesARigidMotionAlone) {
  const Model model = free_bar();
  Positions v(model.vertices, 3);
  for (int i = 0; i < model.vertices; ++i)
    v.row(i) = (Vec3(1, 2, 3) + Vec3(4, -5, 6).cross(Vec3(model.rest.row(i).transpose()))).transpose();
  const Positions before = v;
  calm(model, 0, model.rest, v);
  EXPECT_LT((v - before).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Calming, LeavesTheSwingingOnAHingeAndNothingOfWhatIsClamped) {
  // The vertices of one edge are held for the hinge, those of one end for the clamp.
  const auto held_bar = [](bool clamped) {
    BodyDescription body = test::bar(Polynomial{1e4}, test::Held::nothing);
    Handle handle;
    handle.name = "held";
    const Bounds box = bounds_of(body.mesh.rest);
    for (Eigen::Index i = 0; i < body.mesh.rest.rows(); ++i) {
      const Vec3 p = body.mesh.rest.row(i);
      const bool at_end = p.x() < box.lower.x() + 1e-9, below = p.y() < box.lower.y() + 1e-9;
      if (at_end && (clamped || below)) handle.vertices.push_back(std::int32_t(i));
    }
    body.handles = {handle};
    return build_model(body);
  };
  const Model hinged = held_bar(false), clamped = held_bar(true);
  const auto swinging = [](const Model& model) {
    const Bounds box = bounds_of(model.rest);
    Positions v = Positions::Zero(model.vertices, 3);
    for (int i = 0; i < model.free; ++i)
      v.row(i) = Vec3(0, 0, 2).cross(Vec3(model.rest.row(i).transpose()) - box.lower).transpose();
    return v;
  };
  Positions v = swinging(hinged);
  const Positions before = v;
  calm(hinged, 0, hinged.rest, v);
  EXPECT_LT((v - before).topRows(hinged.free).cwiseAbs().maxCoeff(), 1e-4 * before.cwiseAbs().maxCoeff());
  v = swinging(clamped);
  calm(clamped, 0, clamped.rest, v);
  EXPECT_LT(v.topRows(clamped.free).cwiseAbs().maxCoeff(), 1e-4 * before.cwiseAbs().maxCoeff());
}

}  // namespace calming_test
}  // namespace supple
