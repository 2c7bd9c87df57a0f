// Tests search directions among colliders: against a dense system with the contacts, the planes ahead, and large
// patches.
#include "sim/contact/contact_direction.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/contact_scene.h"

namespace supple {
namespace contact_direction_test {

using test::bar;
using test::ContactScene;
using test::cube;
using test::dense_system;
using test::Held;
using test::shaken;
using test::shape_of;
using test::stacked;

const Shape ground = shape_of(HalfSpace{Vec3::UnitY(), 0});

// Prepares a scene for its first direction: at the first iterate, with its contacts and their stiff directions.
void prepare_direction(ContactScene& scene) {
  scene.w.prepare(scene.model, scene.inputs.solver);
  begin_step(scene.model, scene.inputs, scene.state, scene.w);
  find_contacts_of(scene.model, scene.inputs, scene.w, scene.w.current);
  find_stiff_directions(scene.model, scene.w.current.contacts, scene.w.current.x, scene.w.correction);
}

void stiffen(Eigen::MatrixXd& system, const ContactStencil& stencil, const Vec3& axis, double stiffness) {
  for (int i = 0; i < stencil.free; ++i) {
    for (int j = 0; j < stencil.free; ++j)
      system.block<3, 3>(3 * stencil.vertex[i], 3 * stencil.vertex[j]) +=
          stencil.weight[i] * stencil.weight[j] * stiffness * axis * axis.transpose();
  }
}

// Compares (A + K)^-1 by the Woodbury identity with a dense inverse of A + K. On the flat ground, normals and tangents
// are systems of their own; on the ball all are coupled.
TEST(Contact, LowRankDirectionsSolveTheSystemWithContacts) {
  const std::pair<Collider, double> places[] = {{{"ground", ground, 0, 0.5}, 0.001},
                                                {{"ball", shape_of(Sphere{2}), 0, 0.5}, 1.99}};
  for (const auto& [collider, height] : places) {
    ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {collider}, Vec3(0, height, 0));
    scene.state.v.rowwise() = Eigen::RowVector3d(0.3, -0.5, 0);
    prepare_direction(scene);
    ASSERT_GT(scene.w.correction.wanted.size(), 8u);
    Eigen::MatrixXd system = dense_system(scene.model);
    for (const StiffDirection& s : scene.w.correction.wanted) stiffen(system, s.stencil, s.axis, s.stiffness);
    Positions r = shaken(Positions::Zero(scene.model.free, 3), 1, 2), z(scene.model.free, 3);
    const Eigen::VectorXd wanted = system.ldlt().solve(stacked(r));
    apply_inverse(scene.model, {}, scene.w.correction, scene.w.solve_scratch, r, z);
    // The small system is solved in single precision, the rest in double.
    EXPECT_LT((stacked(z) - wanted).norm(), 1e-4 * wanted.norm()) << collider.name;
  }
}

// What stays of a system keeps its factor; directions must be those of a system that is made anew.
TEST(Contact, DirectionsAreThoseOfANewSystemAfterContactsHaveComeAndGone) {
  const std::pair<Collider, double> places[] = {{{"ground", ground, 0, 0.5}, 0.001},
                                                {{"ball", shape_of(Sphere{2}), 0, 0.5}, 1.99}};
  for (const auto& [collider, height] : places) {
    ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {collider}, Vec3(0, height, 0));
    scene.state.v.rowwise() = Eigen::RowVector3d(0.3, -0.5, 0);
    prepare_direction(scene);
    const std::vector<StiffDirection> all = scene.w.correction.wanted;
    ASSERT_GT(all.size(), 8u);
    const auto applied = [&](ContactCorrection& correction, std::size_t left_out, double stiffer) {
      correction.wanted.clear();
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (left_out > 0 && i % left_out == 1) continue;
        correction.wanted.push_back(all[i]);
        if (i == all.size() / 2) correction.wanted.back().stiffness *= stiffer;
      }
      Positions r = shaken(Positions::Zero(scene.model.free, 3), 1, 2), z(scene.model.free, 3);
      apply_inverse(scene.model, {}, correction, scene.w.solve_scratch, r, z);
      return z;
    };
    for (const auto& [left_out, stiffer] :
         std::vector<std::pair<std::size_t, double>>{{0, 1}, {5, 1}, {3, 1}, {0, 1}, {0, 0.01}, {4, 0.01}, {0, 1}}) {
      ContactCorrection anew;
      const Positions wanted = applied(anew, left_out, stiffer);
      EXPECT_LT((applied(scene.w.correction, left_out, stiffer) - wanted).norm(), 1e-4 * wanted.norm())
          << collider.name << " " << left_out << " " << stiffer;
    }
  }
}

// The body is a bar above the ground, and a direction downwards would lead some vertices through the ground.
TEST(Contact, DirectionsBendAsTheQuadraticModelWithThePlanesAheadDoes) {
  for (const double height : {0.05, 0.046}) {  // nothing touches yet, or some vertices do
    ContactScene scene(bar(Corotated{1e4, 3e4}, Held::hard_end), {{"ground", ground, 0, 0}}, Vec3(0, height, 0));
    scene.state.x += (0.052 - height) * shaken(Positions::Zero(scene.model.vertices, 3), 1, 7);
    scene.state.v.rowwise() = Eigen::RowVector3d(0, -1, 0);
    prepare_direction(scene);
    const std::vector<Contact>& contacts = scene.w.current.contacts;
    const Positions& x = scene.w.current.x;
    Positions direction = Positions::Zero(scene.model.free, 3);
    direction.col(1).setConstant(-0.03);
    Positions r = Positions::Zero(scene.model.free, 3), z(scene.model.free, 3);
    apply_inverse(scene.model, {}, scene.w.correction, scene.w.solve_scratch, r,
                  z);  // makes the system of what touches

    Eigen::MatrixXd system = dense_system(scene.model);
    for (const StiffDirection& s : scene.w.correction.wanted) stiffen(system, s.stencil, s.axis, s.stiffness);
    Positions push = Positions::Zero(scene.model.free, 3);
    int ahead = 0;
    const auto gap_after = [&](const Contact& k, const Positions& d) {
      return k.normal.dot(k.stencil.at(x) + k.stencil.of_free(d)) - k.offset;
    };
    for (const Contact& k : contacts) {
      if (k.depth > 0 || gap_after(k, direction) >= 0) continue;
      ++ahead;
      stiffen(system, k.stencil, k.normal, 2 * k.stiffness);
      k.stencil.spread(-2 * k.stiffness * gap_after(k, direction) * k.normal, push);
    }
    ASSERT_GT(ahead, 0);
    EXPECT_EQ(scene.w.correction.wanted.empty(), height == 0.05);
    const Eigen::VectorXd change = system.ldlt().solve(stacked(push));
    const Positions wanted = direction + Eigen::Map<const Positions>(change.data(), scene.model.free, 3);
    EXPECT_TRUE(foresee_contacts(scene.model, {}, contacts, x, scene.w.correction, direction));
    EXPECT_LT((direction - wanted).norm(), 5e-4 * change.norm()) << height;
  }
}

// The contact patch has more coupled directions than the small system may have.
TEST(Contact, DirectionsOfALargePatchAreSymmetricAndPositiveAndHoldTheVertices) {
  ContactScene scene(cube(16), {{"ball", shape_of(Sphere{2}), 0, 0.5}}, Vec3(0, 2.095, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.3, -0.5, 0);
  prepare_direction(scene);
  ASSERT_GT(scene.w.correction.wanted.size(), most_coupled_directions(scene.model));
  const int n = scene.model.free;
  const auto applied = [&](Positions r) {
    Positions z(n, 3);
    apply_inverse(scene.model, {}, scene.w.correction, scene.w.solve_scratch, r, z);
    return z;
  };
  const Positions a = shaken(Positions::Zero(n, 3), 1, 2), b = shaken(Positions::Zero(n, 3), 1, 3);
  const Positions ha = applied(a), hb = applied(b);
  const auto product = [](const Positions& u, const Positions& v) { return (u.array() * v.array()).sum(); };
  EXPECT_GT(product(a, ha), 0);
  EXPECT_NEAR(product(a, hb), product(b, ha), 1e-4 * std::sqrt(product(a, ha) * product(b, hb)));
  ASSERT_FALSE(scene.w.correction.rest.empty());
  Positions plain(n, 3), r = a;
  solve_system(scene.model, r, plain, scene.w.solve_scratch);
  double held = 0, unheld = 0;
  for (const StiffDirection& s : scene.w.correction.wanted) {
    held += std::abs(s.along(ha));
    unheld += std::abs(s.along(plain));
  }
  EXPECT_LT(held, 0.25 * unheld);
}

}  // namespace contact_direction_test
}  // namespace supple
