// Tests that a collider which comes to a body is treated as a body that comes to the collider.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/impact.h"

namespace supple {
namespace moving_collider_test {

using test::FilmMeasures;
using test::Flies;

std::vector<Material> materials_of_100_kilopascals() {
  const Lame lame = Lame::from_young(1e5, 0.4);
  return {AsRigidAsPossible{lame.mu},
          Polynomial{4 * lame.mu},
          Corotated::from(lame),
          FixedCorotated::from(lame),
          StVenantKirchhoff::from(lame),
          NeoHookean::from(lame),
          StableNeoHookean::from(lame),
          MooneyRivlin::from(lame),
          Spline::preset_a(lame),
          Spline::preset_b(lame),
          StrainLimiting{lame.mu, 0.9, 1.1, lame.mu, 0.7, 1.3}};
}

TEST(MovingCollider, TheSameImpactLooksTheSameFromBothFramesOfReference) {
  for (const Material& material : materials_of_100_kilopascals()) {
    for (const double speed : {3.75, 7.5, 15.0, 30.0}) {
      SCOPED_TRACE(fmt::format("{} at {:g} m/s", name_of(material), speed));
      const FilmMeasures cube = film_of_impact(material, 1000, speed, Flies::cube);
      const FilmMeasures box = film_of_impact(material, 1000, speed, Flies::box);
      ASSERT_FALSE(cube.failed);
      ASSERT_FALSE(box.failed);
      EXPECT_NEAR(std::log(box.energy / cube.energy), 0, std::log(1.2));
      EXPECT_NEAR(std::log(box.stretch / cube.stretch), 0, std::log(1.2));
      if (cube.end_inverted == 0) {
        EXPECT_EQ(box.end_inverted, 0);
      }
    }
  }
}

// A solved step gives the same in the frame of reference in which the collider rests, up to round-off. (What ten
// iterations leave depends on round-off: after one impact of three they are more than 1e-6 of the size apart.)
TEST(MovingCollider, AStepOfAnImpactIsThatOfTheOtherFrameOfReference) {
  const auto stepped = [](const Vec3& velocity, bool box_flies) {
    test::ContactScene scene(test::cube(3, NeoHookean{3e4, 6e4}),
                             {{"box", test::shape_of(Box{Vec3(0.1, 0.5, 0.5), 0}), 0, 0.3}});
    scene.inputs.gravity.setZero();
    scene.inputs.solver.iterations = 100;
    scene.inputs.solver.elements = Precision::double_precision;
    const Vec3 start(-0.22, 0, 0), way = scene.model.time_step * velocity;
    scene.inputs.collider_motions[0] = {test::moved_to(start), test::moved_to(box_flies ? Vec3(start + way) : start)};
    if (!box_flies) scene.state.v.rowwise() = -velocity.transpose();
    EXPECT_FALSE(scene.step().failed);
    EXPECT_GT(scene.w.report.contacts.touching, 0);
    if (box_flies) scene.state.x.rowwise() -= way.transpose();
    return scene.state.x;
  };
  for (int k = 0; k < 30; ++k) {
    const Vec3 velocity(9 + 0.02 * k, -2 + 0.006 * k, 1 - 0.014 * k);
    EXPECT_LT((stepped(velocity, false) - stepped(velocity, true)).cwiseAbs().maxCoeff(), 1e-7 * 0.35) << k;
  }
}

// The collider rests on the cube, and sets off at once. The vertices that touch it start the step inside.
TEST(MovingCollider, ABodyThatTouchesACollidersFaceIsTakenAlongWhenItSetsOff) {
  test::ContactScene scene(test::cube(4, NeoHookean{3e4, 6e4}), {{"box", test::shape_of(Box{Vec3(0.1, 0.5, 0.5), 0})}});
  scene.inputs.gravity.setZero();
  double place = -0.2 + 1e-6;
  for (int frame = 0; frame < 5; ++frame) {
    const double next = place + 0.5;
    scene.inputs.collider_motions[0] = {test::moved_to(Vec3(place, 0, 0)), test::moved_to(Vec3(next, 0, 0))};
    place = next;
    ASSERT_FALSE(scene.step().failed);
    EXPECT_LT(scene.deepest(0), 0.01 * scene.model.size) << frame;
    EXPECT_EQ(deformation(scene.model, scene.state.x).inverted, 0) << frame;
  }
}

// A plate turns by 120 degrees in a step. Seen from it, the cube comes on an arc. It gets no more energy than a cube
// that flies as fast as the plate's edge; before, it got hundreds of times as much.
TEST(MovingCollider, APaddleThatTurnsFarInAStepThrowsTheBodyBeforeIt) {
  const double edge_speed = 0.3 * 2 * 3.14159265358979 * 10;
  const Lame lame = Lame::from_young(1e5, 0.4);
  for (const Material& material :
       {Material{NeoHookean::from(lame)}, Material{FixedCorotated::from(lame)}, Material{MooneyRivlin::from(lame)},
        Material{StableNeoHookean::from(lame)}, Material{Spline::preset_a(lame)}}) {
    SCOPED_TRACE(name_of(material));
    const FilmMeasures film = test::film_of_paddle(material, 1000, 10);
    ASSERT_FALSE(film.failed);
    EXPECT_LT(film.energy, 0.5 * 8 * std::pow(2 * edge_speed, 2));  // off a wall, at most twice the wall's speed
    EXPECT_EQ(film.end_inverted, 0);
  }
}

// A handle turns one face of a cube by 120 degrees in each of five steps, and stops.
TEST(MovingCollider, AHandleThatTurnsFarInAStepLeavesTheBodyWhole) {
  const Lame lame = Lame::from_young(1e5, 0.4);
  for (const Material& material :
       {Material{NeoHookean::from(lame)}, Material{MooneyRivlin::from(lame)}, Material{Spline::preset_b(lame)},
        Material{NeoHookean::from(Lame::from_young(1e6, 0.45))}}) {
    SCOPED_TRACE(name_of(material));
    const FilmMeasures film = test::film_of_handle(material, 1000, 2.0944);
    ASSERT_FALSE(film.failed);
    EXPECT_LT(film.energy, 1000);
    EXPECT_LT(film.end_energy, 1e-3);
    EXPECT_LT(film.end_stretch, 1.01);
    EXPECT_EQ(film.end_inverted, 0);
  }
}

}  // namespace moving_collider_test
}  // namespace supple
