// Tests that the second level of directions, the turning and the error of motion treat each body of a joined model as
// they do where it moves by itself.
#include <cmath>
#include <numeric>

#include "geometry/triangles/surface_thickness.h"
#include "sim/coarse/second_level.h"
#include "sim/coarse/turning.h"
#include "sim/contact/find_contacts.h"
#include "sim/model/joined_model.h"
#include "sim/model/motion_error.h"
#include "support/contact_scene.h"

namespace supple {
namespace joined_second_level_test {

using test::bar;
using test::cube;
using test::Held;
using test::shaken;

// Holds models and the model that joins them.
struct Bodies {
  std::vector<Model> members;
  Model joined;

  explicit Bodies(std::vector<Model> all) : members(std::move(all)) {
    std::vector<const Model*> pointers;
    for (const Model& member : members) pointers.push_back(&member);
    joined = join(pointers);
  }

  // Puts n x 3 numbers of each member into the order of the joined model.
  Positions together(const std::vector<Positions>& of_members) const {
    Positions all(joined.vertices, 3);
    for (std::size_t p = 0; p < members.size(); ++p) {
      const Part& part = joined.parts[p];
      all.middleRows(part.first_free, part.free) = of_members[p].topRows(part.free);
      all.middleRows(part.first_held, part.held) = of_members[p].bottomRows(part.held);
    }
    return all;
  }

  // Returns what belongs to the free vertices of one member.
  Positions free_rows(const Positions& all, std::size_t p) const {
    return all.middleRows(joined.parts[p].first_free, joined.parts[p].free);
  }
};

// Makes a bar that is held at its end, a net without tetrahedra, and a free cube, all of different materials. The cube
// and the bar have too few clusters in all for their numbers to be lowered.
Bodies three_bodies() {
  BodyDescription held = bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::double_precision, 2);
  held.damping = 0.01;
  std::vector<Model> members;
  members.push_back(build_model(held));
  members.push_back(build_model(test::spring_net(3)));
  members.push_back(build_model(cube(3, NeoHookean{2e5, 1e6})));
  return Bodies(std::move(members));
}

std::vector<Positions> shaken_poses(const Bodies& bodies) {
  std::vector<Positions> poses;
  for (const Model& member : bodies.members)
    poses.push_back(shaken(member.rest, 0.005, static_cast<unsigned>(poses.size() + 1)));
  return poses;
}

double distance(const Positions& a, const Positions& b) { return (a - b).norm(); }

TEST(JoinedCoarseSystem, HasTheColumnsOfItsMembersOneAfterTheOther) {
  const Bodies bodies = three_bodies();
  const std::vector<Positions> poses = shaken_poses(bodies);
  const Positions x = bodies.together(poses);
  CoarseSystem joined;
  joined.make(bodies.joined);
  ASSERT_EQ(joined.parts(), 3);
  joined.turn_to(x);
  EXPECT_EQ(joined.columns_of(1), 0);
  int first = 0;
  for (std::size_t p = 0; p < 3; ++p) {
    const Model& member = bodies.members[p];
    CoarseSystem alone;
    alone.make(member);
    ASSERT_EQ(joined.columns_of(static_cast<int>(p)), alone.columns());
    alone.turn_to(poses[p]);
    for (int column = 0; column < alone.columns(); ++column) {
      Positions expected = Positions::Zero(member.free, 3), motion = Positions::Zero(bodies.joined.free, 3);
      alone.prolong(member, poses[p], Eigen::VectorXd::Unit(alone.columns(), column), nullptr, expected);
      joined.prolong(bodies.joined, x, Eigen::VectorXd::Unit(joined.columns(), first + column), nullptr, motion);
      EXPECT_LT(distance(bodies.free_rows(motion, p), expected), 1e-12 * expected.norm());
      EXPECT_NEAR(motion.norm(), expected.norm(), 1e-12 * expected.norm());  // other bodies do not move
    }
    first += alone.columns();
  }
  EXPECT_EQ(joined.columns(), first);
}

TEST(JoinedCoarseSystem, SharesOutAFewClustersAmongManyBodies) {
  const Model one = build_model(cube(3));
  const int alone = wanted_clusters(one).front();
  for (const int count : {2, 12, 40}) {
    const Model joined = join(std::vector<const Model*>(static_cast<std::size_t>(count), &one));
    const std::vector<int> wanted = wanted_clusters(joined);
    ASSERT_EQ(std::ssize(wanted), count);
    const int sum = std::accumulate(wanted.begin(), wanted.end(), 0);
    EXPECT_LE(sum, std::max(32, count));
    for (const int clusters : wanted) EXPECT_GE(clusters, 1);
    EXPECT_LE(sum, count * alone);
    EXPECT_TRUE(sum == 2 * alone || count > 2);
    EXPECT_EQ(make_clusters(joined, wanted).count(), sum);
  }
}

TEST(JoinedSecondLevel, HasABlockForEachMember) {
  const Bodies bodies = three_bodies();
  const std::vector<Positions> poses = shaken_poses(bodies);
  SecondLevel joined;
  ASSERT_TRUE(joined.begin(bodies.joined, bodies.together(poses)));
  EXPECT_EQ(joined.difference(1).size(), 0);
  for (const int p : {0, 2}) {
    SecondLevel alone;
    ASSERT_TRUE(alone.begin(bodies.members[p], poses[p]));
    const Eigen::MatrixXd& expected = alone.difference(0);
    ASSERT_EQ(joined.difference(p).rows(), expected.rows());
    EXPECT_LT((joined.difference(p) - expected).norm(), 1e-12 * expected.norm());
    const int first = joined.system().first_column(p), count = joined.system().columns_of(p);
    Eigen::VectorXd numbers = Eigen::VectorXd::Zero(joined.columns());
    numbers.segment(first, count).setRandom();
    Eigen::VectorXd product = joined.difference_times(numbers);
    const Eigen::VectorXd own = expected * numbers.segment(first, count);
    EXPECT_LT((product.segment(first, count) - own).norm(), 1e-12 * own.norm());
    product.segment(first, count).setZero();
    EXPECT_TRUE(product.isZero(0));
  }
}

TEST(JoinedSecondLevel, AddsWhatItsMembersAdd) {
  const Bodies bodies = three_bodies();
  const std::vector<Positions> poses = shaken_poses(bodies);
  const Positions x = bodies.together(poses);
  const Positions forces = shaken(Positions::Zero(bodies.joined.free, 3), 1, 7);
  SecondLevel joined;
  ASSERT_TRUE(joined.begin(bodies.joined, x));
  Positions motion = Positions::Zero(bodies.joined.free, 3);
  joined.add_to(bodies.joined, forces, nullptr, motion);
  EXPECT_TRUE(bodies.free_rows(motion, 1).isZero(0));
  for (const int p : {0, 2}) {
    const Model& member = bodies.members[p];
    SecondLevel alone;
    ASSERT_TRUE(alone.begin(member, poses[p]));
    Positions expected = Positions::Zero(member.free, 3);
    alone.add_to(member, bodies.free_rows(forces, p), nullptr, expected);
    EXPECT_LT(distance(bodies.free_rows(motion, p), expected), 1e-12 * expected.norm()) << p;
  }
}

TEST(JoinedSecondLevel, KeepsTheOtherBodiesWhereOneIsFarFromItsRestShape) {
  const Bodies bodies = three_bodies();
  std::vector<Positions> poses = shaken_poses(bodies);
  poses[2].col(1) *= 0.2;
  SecondLevel joined, bar_alone, cube_alone;
  EXPECT_FALSE(cube_alone.begin(bodies.members[2], poses[2]));
  ASSERT_TRUE(bar_alone.begin(bodies.members[0], poses[0]));
  ASSERT_TRUE(joined.begin(bodies.joined, bodies.together(poses)));
  EXPECT_TRUE(joined.difference(2).isZero(0));
  EXPECT_LT((joined.difference(0) - bar_alone.difference(0)).norm(), 1e-12 * bar_alone.difference(0).norm());
}

TEST(JoinedSecondLevel, IsLeftOutOfTheBodyThatADoesNotKeepFromTurning) {
  std::vector<Model> members;
  members.push_back(build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::double_precision, 2)));
  members.push_back(build_model(cube(3, Corotated{100, 200})));
  const Bodies bodies(std::move(members));
  const std::vector<Positions> poses = shaken_poses(bodies);
  SecondLevel joined, bar_alone, cube_alone;
  EXPECT_FALSE(cube_alone.begin(bodies.members[1], poses[1]));
  ASSERT_TRUE(bar_alone.begin(bodies.members[0], poses[0]));
  ASSERT_TRUE(joined.begin(bodies.joined, bodies.together(poses)));
  EXPECT_GT(joined.difference(1).rows(), 0);
  EXPECT_TRUE(joined.difference(1).isZero(0));
  EXPECT_LT((joined.difference(0) - bar_alone.difference(0)).norm(), 1e-12 * bar_alone.difference(0).norm());
}

TEST(JoinedTurning, CorrectsWhatItsMembersCorrect) {
  const Bodies bodies = three_bodies();
  std::vector<Positions> rest, motions;
  for (const Model& member : bodies.members) {
    const Vec3 spin = (0.1 + 0.1 * static_cast<double>(rest.size())) * Vec3(1, -2, 1).normalized();
    Positions motion = Positions::Zero(member.vertices, 3);
    for (int v = 0; v < member.free; ++v) motion.row(v) = spin.cross(Vec3(member.rest.row(v))).transpose();
    rest.push_back(member.rest);
    motions.push_back(motion);
  }
  CoarseSystem joined;
  joined.make(bodies.joined);
  Turning turning;
  SolveScratch scratch;
  Positions correction, expected;
  const Positions x = bodies.together(rest);
  turning.take_tangent(joined, x, bodies.together(motions));
  turning.correct(bodies.joined, joined, x, scratch, correction);
  for (const int p : {0, 2}) {
    const Model& member = bodies.members[p];
    CoarseSystem system;
    system.make(member);
    Turning alone;
    alone.take_tangent(system, rest[p], motions[p]);
    EXPECT_NEAR(turning.energy_of(p), alone.energy(), 1e-12 * alone.energy());
    alone.correct(member, system, rest[p], scratch, expected);
    EXPECT_GT(expected.norm(), 0);
    EXPECT_LT(distance(bodies.free_rows(correction, p), expected), 1e-12 * expected.norm()) << p;
  }
}

// A bar that flies fast and is solved well does not hide a cube that is far from where it should be.
TEST(JoinedMotionError, IsTheLargestOfItsMembers) {
  const Bodies bodies = three_bodies();
  const std::vector<Positions> q = shaken_poses(bodies);
  std::vector<Positions> y = q, solved = q, x = q, ahead;
  const std::vector<double> speed = {1, 0.1, 1e-3}, off = {1e-3, 1e-4, 5e-4};
  double worst = 0;
  for (std::size_t p = 0; p < q.size(); ++p) {
    const Model& member = bodies.members[p];
    y[p].topRows(member.free).array() += speed[p];
    solved[p].topRows(member.free).array() += 0.9 * speed[p];
    x[p].topRows(member.free) = shaken(solved[p].topRows(member.free), off[p], 5);
    ahead.push_back(solved[p] - x[p]);
    worst = std::max(worst, motion_error(member, q[p], y[p], x[p], solved[p]));
  }
  EXPECT_GT(worst, 0.1);
  const auto all = [&](const std::vector<Positions>& of_members) { return bodies.together(of_members); };
  EXPECT_NEAR(motion_error(bodies.joined, all(q), all(y), all(x), all(solved)), worst, 1e-12 * worst);
  const Positions d = all(ahead).topRows(bodies.joined.free);
  for (std::size_t p = 0; p < q.size(); ++p) {
    const Model& member = bodies.members[p];
    const double length = mass_length(member, member.parts[0], ahead[p]);
    EXPECT_NEAR(mass_length(bodies.joined, bodies.joined.parts[p], d), length, 1e-12 * length) << p;
    const double motion = own_motion(member, member.parts[0], q[p], y[p], x[p]);
    EXPECT_NEAR(own_motion(bodies.joined, bodies.joined.parts[p], all(q), all(y), all(x)), motion, 1e-12 * motion) << p;
  }
}

// Two cubes lie on the two sides of a thick wall, deep inside it. Each leaves by its own side.
TEST(JoinedContacts, EachBodyHasItsOwnWayOut) {
  std::vector<Model> members;
  for (int i = 0; i < 3; ++i) members.push_back(build_model(cube(2)));
  const Bodies bodies(std::move(members));
  const std::vector<Collider> wall = {{"wall", test::shape_of(Box{Vec3(2, 0.5, 2), 0}), 0, 0}};
  StepInputs inputs = test::still_inputs(bodies.joined);
  inputs.colliders = &wall;
  inputs.collider_motions.resize(1);
  std::vector<Positions> poses;
  for (const double height : {0.45, -0.45, 5.0}) {
    poses.push_back(bodies.members[0].rest);
    poses.back().col(1).array() += height;
  }
  const Positions q = bodies.together(poses);
  ContactWork work;
  begin_contacts(bodies.joined, inputs, q, q, nullptr, work);
  ASSERT_EQ(work.way_out.size(), 3u);
  EXPECT_GT(work.way_out[0].y(), 0.9);
  EXPECT_LT(work.way_out[1].y(), -0.9);
  EXPECT_TRUE(work.way_out[2].isZero(0));
}

}  // namespace joined_second_level_test
}  // namespace supple
