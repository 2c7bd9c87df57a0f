// Tests that friction is at work in the first step of a film already, where bodies touch what they stand on, and that
// later steps and bodies in the air have the bits of a step that knows of nothing before it.
#include "sim/solver/first_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/contact_scene.h"

namespace supple {
namespace first_forces_test {

using test::ContactScene;
using test::cube;
using test::shape_of;

const Corotated stiff{3e5, 6e5};
constexpr double g = 9.81, h = 1.0 / 30;

Vec3 mean_velocity(const ContactScene& scene) {
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < scene.model.vertices; ++v) sum += scene.model.mass[v] * Vec3(scene.state.v.row(v).transpose());
  return sum / scene.model.total_mass;
}

TEST(FirstForces, SlowABlockThatSlidesFromItsFirstStepOn) {
  const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5};
  ContactScene scene(cube(3, stiff), {ground}, {0, 0.1, 0});
  scene.state.v.col(0).setConstant(1);
  double before = 1;
  for (int frame = 0; frame < 4; ++frame) {
    ASSERT_FALSE(scene.step().failed);
    const double lost = before - mean_velocity(scene).x();
    EXPECT_NEAR(lost, 0.5 * g * h, 0.02 * 0.5 * g * h) << "frame " << frame;
    before -= lost;
  }
}

TEST(FirstForces, HoldABlockOnASlopeFromItsFirstStepOn) {
  const double angle = 20 * std::numbers::pi / 180;
  const Vec3 normal(0, std::cos(angle), std::sin(angle)), down(0, -std::sin(angle), std::cos(angle));
  for (const double friction : {0.5, 0.2}) {
    BodyDescription body = cube(3, stiff);
    body.mesh.rest = body.mesh.rest * Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix().transpose();
    ContactScene scene(body, {{"slope", shape_of(HalfSpace{normal, 0}), 0, friction}}, 0.1 * normal);
    ASSERT_FALSE(scene.step().failed);
    const double freely = g * h * std::sin(angle), held = friction * g * h * std::cos(angle);
    if (held < freely) {
      EXPECT_NEAR(mean_velocity(scene).dot(down), freely - held, 0.1 * freely);
      continue;
    }
    // The block shears a little over its lower side, which stays.
    double fastest = 0;
    for (int v = 0; v < scene.model.vertices; ++v) {
      if (std::abs(normal.dot(Vec3(scene.model.rest.row(v).transpose())) + 0.1) < 1e-9)
        fastest = std::max(fastest, std::abs(down.dot(Vec3(scene.state.v.row(v).transpose()))));
    }
    EXPECT_LT(fastest, 0.03 * freely);  // where it presses least
    EXPECT_LT(mean_velocity(scene).dot(down), 0.1 * freely);
  }
}

TEST(FirstForces, AreNotAskedForInTheAirWithoutFrictionAndInLaterSteps) {
  struct Case {
    const char* what;
    double friction, height, time;
    bool asked;
  };
  for (const Case& one : {Case{"touches", 0.5, 0.1, 0, true},
                          {"smooth", 0, 0.1, 0, false},
                          {"in the air", 0.5, 0.101, 0, false},
                          {"later", 0.5, 0.1, h, false}}) {
    const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, one.friction};
    ContactScene scene(cube(3, stiff), {ground}, {0, one.height, 0});
    scene.state.time = one.time;
    ASSERT_FALSE(scene.step().failed);
    EXPECT_EQ(!scene.w.contact.pressed_at_first.empty(), one.asked) << one.what;
    ASSERT_FALSE(scene.step().failed);
    EXPECT_TRUE(scene.w.contact.pressed_at_first.empty()) << one.what;
  }
}

// The search for these forces borrows the second level of the step's workspace. What either did before, for this body
// or another one, changes no bit.
TEST(FirstForces, DoNotDependOnWhatTheWorkspaceDidBefore) {
  const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5};
  for (const int levels : {1, 2}) {
    const auto scene_of = [&](int cells) {
      ContactScene scene(cube(cells, stiff), {ground}, {0, 0.1, 0});
      scene.state.v.col(0).setConstant(1);
      scene.inputs.solver.levels = levels;
      return scene;
    };
    const auto two_steps = [](ContactScene& scene, OpenWorkspace& w) {
      scene.inputs.colliders = &scene.colliders;
      step(scene.model, scene.inputs, scene.state, w);
      const std::vector<double> pressed = w.contact.pressed_at_first;
      step(scene.model, scene.inputs, scene.state, w);
      return pressed;
    };
    ContactScene scene = scene_of(4), again = scene_of(4), other = scene_of(3);
    OpenWorkspace fresh, used;
    const std::vector<double> expected = two_steps(scene, fresh);
    EXPECT_FALSE(expected.empty());
    two_steps(other, used);
    EXPECT_EQ(two_steps(again, used), expected) << levels;
    EXPECT_EQ(again.state.x, scene.state.x) << levels;
    ContactScene once_more = scene_of(4);
    EXPECT_EQ(two_steps(once_more, used), expected) << levels;
    EXPECT_EQ(once_more.state.x, scene.state.x) << levels;
  }
}

}  // namespace first_forces_test
}  // namespace supple
