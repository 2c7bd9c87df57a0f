// Tests directions of cloth whose contacts stick: against dense matrices, for symmetry, and when they serve.
#include "sim/contact/sticking_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/contact_scene.h"

namespace supple {
namespace sticking_system_test {

using test::shaken;
using test::shape_of;
using test::stacked;

// A sheet with its contacts at the first iterate of a step. Its vertices lie a little in the ground.
struct Lying : test::ContactScene {
  explicit Lying(const Eigen::Vector2i& cells, double speed = 0, double friction = 0.4)
      : ContactScene(test::sheet({0.4, 0.3}, cells, {Woven{900, 700, 20, 0.05, 1.1}, 1e-4}),
                     {{"ground", shape_of(HalfSpace{Vec3::UnitZ(), 0}), 0, friction}}, Vec3(0, 0, -1e-5)) {
    inputs.gravity = Vec3(0, 0, -9.81);
    state.v.col(0).setConstant(speed);
    w.prepare(model, inputs.solver);
    begin_step(model, inputs, state, w);
    w.current.x = state.x + model.time_step * state.v;
    find_contacts_of(model, inputs, w, w.current);
    find_stiff_directions(model, w.current.contacts, w.current.x, w.correction);
  }
  void choose() { choose_sticking_system(model, inputs.solver.contact, w.current.x, w.correction); }
  Positions applied(Positions r) {
    Positions z(model.free, 3);
    apply_inverse(model, inputs.solver.contact, w.correction, w.solve_scratch, r, z);
    return z;
  }
};

TEST(StickingSystem, SolvesTheMatrixWithASpringForEachContact) {
  Lying scene({20, 15});
  scene.choose();
  const ContactCorrection& c = scene.w.correction;
  ASSERT_TRUE(c.stuck.serves());
  ASSERT_TRUE(c.loose.empty());
  ASSERT_EQ(c.sticking.size(), std::size_t(scene.model.free));
  Eigen::MatrixXd matrix = test::dense(scene.model.matrix);
  for (const StickingSystem::Spring& spring : c.sticking) {
    const std::int32_t v = spring.stencil.vertex[0];
    EXPECT_GE(spring.stiffness, c.wanted[v].stiffness * (1 - 1e-12));
    matrix(v, v) += spring.stiffness;
    EXPECT_NEAR(c.stuck.diagonal()[v], matrix(v, v), 1e-12 * matrix(v, v));
  }
  const Positions r = shaken(Positions::Zero(scene.model.free, 3), 1, 2);
  const Eigen::MatrixXd wanted = matrix.llt().solve(Eigen::MatrixXd(r));
  EXPECT_LT((scene.applied(r) - wanted).norm(), 1e-4 * wanted.norm());
}

// Some contacts are taken for ones that slide, which are scaled by themselves.
TEST(StickingSystem, LeavesDirectionsSymmetricAndPositive) {
  Lying scene({20, 15});
  ContactCorrection& c = scene.w.correction;
  for (std::size_t i = 0; i < c.normals; i += 3) c.loose.push_back(c.wanted[i]);
  std::erase_if(c.sticking, [](const StickingSystem::Spring& s) { return s.stencil.vertex[0] % 3 == 0; });
  scene.choose();
  ASSERT_TRUE(c.stuck.serves());
  const Positions a = shaken(Positions::Zero(scene.model.free, 3), 1, 2);
  const Positions b = shaken(Positions::Zero(scene.model.free, 3), 1, 3);
  const Positions of_a = scene.applied(a), of_b = scene.applied(b);
  const double ab = stacked(of_a).dot(stacked(b)), ba = stacked(a).dot(stacked(of_b));
  EXPECT_NEAR(ab, ba, 1e-4 * std::sqrt(stacked(of_a).dot(stacked(a)) * stacked(of_b).dot(stacked(b))));
  EXPECT_GT(stacked(of_a).dot(stacked(a)), 0);
}

TEST(StickingSystem, ServesWhereTheSmallSystemHasNoRoomAndMostContactsStick) {
  const auto serves = [](Lying scene) {
    scene.choose();
    return scene.w.correction.stuck.serves();
  };
  EXPECT_TRUE(serves(Lying({20, 15})));
  EXPECT_FALSE(serves(Lying({8, 6}))) << "the small system has room";
  EXPECT_FALSE(serves(Lying({20, 15}, 0.5))) << "it slides";
  EXPECT_FALSE(serves(Lying({20, 15}, 0, 0))) << "nothing rubs";
}

TEST(StickingSystem, ServesOneStep) {
  Lying scene({20, 15});
  scene.choose();
  begin_step(scene.model, scene.inputs, scene.state, scene.w);
  EXPECT_FALSE(scene.w.correction.stuck.serves());
}

// What is kept from step to step must be what would be made.
TEST(StickingSystem, IsMadeAnewWhereContactsOrPlacesAreOthers) {
  Lying scene({20, 15});
  scene.choose();
  const Positions r = shaken(Positions::Zero(scene.model.free, 3), 1, 2);
  ContactCorrection& c = scene.w.correction;
  Positions before = scene.applied(r);
  const auto expect_fresh = [&](const char* what) {
    c.stuck.clear();
    c.loose.clear();
    scene.choose();
    StickingSystem fresh;
    fresh.make(scene.model, c.sticking, scene.w.current.x);
    Positions z(scene.model.free, 3);
    fresh.solve(r, z);
    EXPECT_EQ(z, scene.applied(r)) << what;
    return z;
  };
  EXPECT_EQ(expect_fresh("the same"), before);
  c.sticking.resize(c.sticking.size() - 40);
  EXPECT_NE(expect_fresh("fewer contacts"), before);
  before = scene.applied(r);
  scene.w.current.x.col(0).swap(scene.w.current.x.col(2));  // another order, and so another rounding
  scene.w.current.x.col(0) *= 10;
  EXPECT_NE(expect_fresh("other places"), before);
}

TEST(StickingSystem, ScalesContactsThatBeginToStickLater) {
  Lying scene({20, 15});
  ContactCorrection& c = scene.w.correction;
  const std::vector<StickingSystem::Spring> all = c.sticking;
  c.sticking.resize(all.size() - 10);
  scene.choose();
  ASSERT_TRUE(c.stuck.serves());
  ASSERT_TRUE(c.loose.empty());
  c.sticking = all;
  scene.choose();
  ASSERT_EQ(c.loose.size(), 30u);
  for (std::size_t i = 0; i < c.loose.size(); ++i) {
    EXPECT_EQ(c.loose[i].stencil, all[all.size() - 10 + i / 3].stencil);
    EXPECT_EQ(c.loose[i].stiffness, all[all.size() - 10 + i / 3].stiffness);
  }
}

// The way that is left is that of the true stiffness of all contacts.
TEST(StickingSystem, IsCorrectedToTheSystemOfAllContacts) {
  Lying scene({20, 15}, 3e-3);  // slips so far that friction is soft beside the normals
  scene.choose();
  const ContactCorrection& c = scene.w.correction;
  ASSERT_TRUE(c.stuck.serves());
  Eigen::MatrixXd system = test::dense_system(scene.model);
  for (const StiffDirection& s : c.wanted) {
    Positions n = Positions::Zero(scene.model.free, 3);
    s.add(1, n);
    system += s.stiffness * stacked(n) * stacked(n).transpose();
  }
  Positions r = shaken(Positions::Zero(scene.model.free, 3), 0.1, 2);
  r.col(0).array() += 1;  // which the sheet gives way to as a whole
  const Eigen::VectorXd wanted = system.llt().solve(stacked(r));
  Positions z;
  ASSERT_TRUE(solve_with_all_contacts(scene.model, scene.w.correction, r, z));
  EXPECT_LT((stacked(z) - wanted).norm(), 0.05 * wanted.norm());
  EXPECT_GT((stacked(scene.applied(r)) - wanted).norm(), 0.1 * wanted.norm());
}

// Cloth that lies must begin to slide when gravity leads it along the ground more steeply than friction holds.
TEST(StickingSystem, LetsClothSlideThatLies) {
  constexpr double friction = 0.3, slope = 0.5, seconds = 0.5;  // slope: the tangent of the angle
  Lying scene({20, 15}, 0, friction);
  const double angle = std::atan(slope);
  scene.inputs.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  scene.inputs.solver.still = 1e-6;
  const double from = scene.center().x();
  for (int i = 0; i < seconds / scene.model.time_step; ++i) scene.step();
  const double wanted = 9.81 * (std::sin(angle) - friction * std::cos(angle)) * seconds * seconds / 2;
  EXPECT_NEAR(scene.center().x() - from, wanted, 0.15 * wanted);
}

// The first step of a slide goes a millionth of a metre or two. Directions of the matrix with what sticks see a tenth
// of it; what is left must be shorter than a millionth of the sheet's size.
TEST(StickingSystem, SeesTheSlowestSlideAsAllIterationsDo) {
  double way[2];
  for (const bool all : {false, true}) {
    Lying scene({20, 15}, 0, 0.3);
    scene.inputs.gravity = 9.81 * Vec3(std::sin(std::atan(0.5)), 0, -std::cos(std::atan(0.5)));
    scene.inputs.solver.still = all ? 0 : 1e-6;
    const double from = scene.center().x();
    scene.step();
    EXPECT_TRUE(scene.w.correction.stuck.serves());
    way[all] = scene.center().x() - from;
  }
  EXPECT_GT(way[0], 0.4 * way[1]);
  EXPECT_GT(way[1], 1e-6);
}

// A slow slide is braked, as steps that make all iterations brake it.
TEST(StickingSystem, BrakesSlowClothAsAllIterationsDo) {
  double way[2];
  for (const bool all : {false, true}) {
    Lying scene({20, 15});
    scene.inputs.solver.still = all ? 0 : 1e-6;
    scene.state.v.col(0).setConstant(5e-4);
    const double from = scene.center().x();
    for (int i = 0; i < 30; ++i) scene.step();
    way[all] = scene.center().x() - from;
  }
  EXPECT_LT(std::abs(way[0] - way[1]), 1e-5 * 0.5) << way[0] << " " << way[1];
  EXPECT_LT(way[1], 0.5 * 5e-4) << "half of the way without friction";
}

}  // namespace sticking_system_test
}  // namespace supple
