// Tests contact of bodies whose drawn surface touches colliders in the stead of their vertices.
#include <gtest/gtest.h>

#include <numbers>

#include "sim/contact/find_contacts.h"
#include "sim/model/joined_model.h"
#include "support/contact_scene.h"

namespace supple {
namespace drawn_place_test {

using test::ContactScene;
using test::cube;
using test::shape_of;

const Corotated stiff{3e5, 6e5};

Collider ground() { return {"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5}; }

// Makes a cube whose drawn surface lies this far inside it on all sides; below zero, outside.
BodyDescription cube_drawn_inside(double depth) {
  BodyDescription body = cube(3, stiff);
  body.drawn_offset = -depth / 0.1 * body.mesh.rest;
  return body;
}

double lowest_after(ContactScene& scene, int steps) {
  for (int frame = 0; frame < steps; ++frame) EXPECT_FALSE(scene.step().failed) << frame;
  return scene.state.x.col(1).minCoeff();
}

TEST(DrawnPlaces, StandOnTheGroundWhereTheVerticesWould) {
  for (const double depth : {0.02, -0.02}) {
    ContactScene plain(cube(3, stiff), {ground()}, {0, 0.15, 0});
    ContactScene drawn(cube_drawn_inside(depth), {ground()}, {0, 0.15, 0});
    const double lowest = lowest_after(plain, 60);
    EXPECT_NEAR(lowest_after(drawn, 60), lowest - depth, 2e-3) << depth;
    EXPECT_LT(drawn.fastest(), 1e-3);
  }
}

TEST(DrawnPlaces, TurnWithTheBody) {
  BodyDescription body = cube_drawn_inside(0.02);
  const Mat3 turn = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ()).toRotationMatrix();
  body.drawn_offset.col(0).setZero();  // at rest, only the drawn top and bottom lie inside
  body.drawn_offset.col(2).setZero();
  ContactScene scene(body, {ground()}, {0, 0.15, 0});
  for (int v = 0; v < scene.model.vertices; ++v)
    scene.state.x.row(v) = (turn * scene.model.rest.row(v).transpose()).transpose() + Eigen::RowVector3d(0, 0.15, 0);
  const Positions offsets = drawn_offsets(scene.model, scene.state.x, nullptr);
  EXPECT_NEAR(offsets.col(0).cwiseAbs().maxCoeff(), 0.02, 1e-9);
  EXPECT_LT(offsets.col(1).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(lowest_after(scene, 60), 0, 2e-3);  // it stands on a side that is drawn where the elements are
}

TEST(DrawnPlaces, HaveFrictionAndHoldOnASlope) {
  const double angle = 0.2;
  const Vec3 normal(std::sin(angle), std::cos(angle), 0);
  ContactScene scene(cube_drawn_inside(0.02), {{"slope", shape_of(HalfSpace{normal, 0}), 0, 0.8}}, 0.12 * normal);
  lowest_after(scene, 30);
  const Vec3 before = scene.center();
  lowest_after(scene, 30);
  EXPECT_LT((scene.center() - before).norm(), 1e-3);
}

TEST(DrawnPlaces, OfSeveralBodiesAreTheirOwnInAJoinedModel) {
  const Model plain = build_model(cube(2, stiff)), drawn = build_model(cube_drawn_inside(0.02));
  const Model joined = join({&plain, &drawn});
  const Positions own = drawn_offsets(drawn, drawn.rest, nullptr);
  const Positions all = drawn_offsets(joined, joined.rest, nullptr);
  ASSERT_EQ(all.rows(), joined.vertices);
  EXPECT_EQ(rows_of(joined.parts[0], all).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ((rows_of(joined.parts[1], all) - own).cwiseAbs().maxCoeff(), 0);
}

}  // namespace drawn_place_test
}  // namespace supple
