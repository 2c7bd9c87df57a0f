// Tests directions of bodies that meet against dense systems, on one level and on both.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "sim/contact/contact_direction.h"
#include "sim/model/joined_model.h"
#include "support/bodies.h"

namespace supple {
namespace joined_directions_test {

using test::bar;
using test::Held;
using test::shaken;

// Makes bars of different stiffness, each of which is held at one end.
struct Bars {
  std::vector<Model> members;
  Model joined;

  explicit Bars(int count) {
    for (int k = 0; k < count; ++k) members.push_back(build_model(bar(Corotated{1e4 * (1 + k), 3e4}, Held::hard_end)));
    std::vector<const Model*> pointers;
    for (const Model& member : members) pointers.push_back(&member);
    joined = join(pointers);
  }
};

// Touches neighbours of a ring of bodies at some places: normals first, then two tangents of each.
void touch(const Model& model, int places, ContactCorrection& c) {
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  std::vector<StiffDirection> tangents;
  const auto parts = static_cast<int>(model.parts.size());
  for (int i = 0; i < places; ++i) {
    const Part &one = model.parts[i % parts], &other = model.parts[(i + 1) % parts];
    const auto any = [&](const Part& part) {
      return part.first_free + static_cast<std::int32_t>(random() % static_cast<unsigned>(part.free - 2));
    };
    const std::int32_t vertex = any(one), corner = any(other);
    ContactStencil stencil;
    stencil.count = stencil.free = 4;
    if (vertex < corner) {
      stencil.vertex = {vertex, corner, corner + 1, corner + 2};
      stencil.weight = {1, -0.5, -0.3, -0.2};
    } else {
      stencil.vertex = {corner, corner + 1, corner + 2, vertex};
      stencil.weight = {-0.5, -0.3, -0.2, 1};
    }
    const Vec3 normal = Vec3(number(random), number(random), number(random)).normalized();
    const Vec3 side = normal.cross(Vec3::UnitX()).normalized();
    const double stiffness = 20 * model.diagonal[0];
    c.wanted.push_back({stencil, normal, stiffness});
    tangents.push_back({stencil, side, 0.1 * stiffness});
    tangents.push_back({stencil, normal.cross(side), 0.1 * stiffness});
  }
  c.normals = c.wanted.size();
  c.wanted.insert(c.wanted.end(), tangents.begin(), tangents.end());
}

Positions applied(const Model& model, ContactCorrection& c, Positions r) {
  SolveScratch scratch;
  Positions z(model.free, 3);
  apply_inverse(model, {}, c, scratch, r, z);
  return z;
}

Eigen::Map<const Eigen::VectorXd> stacked(const Positions& r) { return {r.data(), r.size()}; }

// B^-1 is found by its columns, without contacts.
Eigen::MatrixXd inverse_without_contacts(const Model& model, SecondLevel* second) {
  ContactCorrection c;
  c.second = second;
  Eigen::MatrixXd inverse(3 * model.free, 3 * model.free);
  for (Eigen::Index i = 0; i < inverse.cols(); ++i) {
    Positions unit = Positions::Zero(model.free, 3);
    unit.data()[i] = 1;
    inverse.col(i) = stacked(applied(model, c, unit));
  }
  return inverse;
}

TEST(JoinedDirections, SolveTheSystemWithTheContactsBetweenBodies) {
  const Bars bars(5);
  const Model& model = bars.joined;
  SecondLevel level;
  ASSERT_TRUE(level.begin(model, shaken(model.rest, 0.002, 1)));
  for (SecondLevel* const second : {static_cast<SecondLevel*>(nullptr), &level}) {
    const Eigen::MatrixXd inverse = inverse_without_contacts(model, second);
    ContactCorrection c;
    c.second = second;
    begin_corrections(model, c);
    touch(model, 30, c);
    const auto count = std::ssize(c.wanted);
    Eigen::MatrixXd n = Eigen::MatrixXd::Zero(inverse.rows(), count);
    Eigen::VectorXd compliance(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      Positions column = Positions::Zero(model.free, 3);
      c.wanted[i].add(1, column);
      n.col(i) = stacked(column);
      compliance[i] = 1 / c.wanted[i].stiffness;
    }
    Eigen::MatrixXd small = n.transpose() * inverse * n;
    small.diagonal() += compliance;
    const Positions r = shaken(Positions::Zero(model.free, 3), 1, 2);
    const Eigen::VectorXd free = inverse * stacked(r);
    const Eigen::VectorXd wanted = free - inverse * (n * small.llt().solve(n.transpose() * free));
    const Positions z = applied(model, c, r);
    EXPECT_TRUE(c.rest.empty());
    EXPECT_EQ(std::ssize(c.system.directions()), count);
    EXPECT_GT((wanted - free).norm(), 0.1 * free.norm());
    EXPECT_LT((stacked(z) - wanted).norm(), 2e-4 * wanted.norm()) << (second != nullptr);
  }
}

// A pile has room for all of its directions. Of those between two bodies alone, tangents are scaled by themselves.
TEST(JoinedDirections, AreLimitedByTheWorkOfTheirFactor) {
  const Bars many(20), two(2);
  ContactCorrection pile, layer;
  begin_corrections(many.joined, pile);
  touch(many.joined, 900, pile);
  applied(many.joined, pile, shaken(Positions::Zero(many.joined.free, 3), 1, 2));
  EXPECT_TRUE(pile.rest.empty());
  EXPECT_EQ(pile.system.directions().size(), 2700u);
  begin_corrections(two.joined, layer);
  touch(two.joined, 300, layer);
  applied(two.joined, layer, shaken(Positions::Zero(two.joined.free, 3), 1, 2));
  EXPECT_LT(layer.system.directions().size(), 900u);
  EXPECT_GT(layer.system.directions().size(), 400u);
  EXPECT_EQ(layer.system.directions().size() + layer.rest.size(), 900u);
  const auto is_normal = [&](const StiffDirection& s) { return s.stiffness > 10 * two.joined.diagonal[0]; };
  const std::vector<StiffDirection>& held = layer.system.directions();
  EXPECT_EQ(std::count_if(held.begin(), held.end(), is_normal), 300);
}

}  // namespace joined_directions_test
}  // namespace supple
