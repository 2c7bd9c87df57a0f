// Tests the second level of search directions: matrices of clusters, directions with and without contacts, arcs,
// and what it is for: bodies that turn as they should.
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "baselines/reference.h"
#include "geometry/triangles/surface_thickness.h"
#include "sim/measures/measures.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/lbfgs.h"
#include "support/contact_scene.h"
#include "support/sparse_matrices.h"

namespace supple {
namespace second_level_test {

using test::bar;
using test::cube;
using test::Held;
using test::shaken;

Eigen::Map<const Eigen::VectorXd> flat(const Positions& x) { return {x.data(), x.size()}; }

// Returns Z, 3 n_free x r, at x.
Eigen::MatrixXd motions_of(const Model& model, CoarseSystem& system, const Positions& x) {
  Eigen::MatrixXd z(3 * model.free, system.columns());
  Positions motion(model.vertices, 3);
  for (int c = 0; c < system.columns(); ++c) {
    motion.setZero();
    system.prolong(model, x, Eigen::VectorXd::Unit(system.columns(), c), nullptr, motion);
    z.col(c) = flat(motion.topRows(model.free));
  }
  return z;
}

Eigen::MatrixXd whole(const Eigen::MatrixXd& lower) { return lower.selfadjointView<Eigen::Lower>(); }

// Returns the positions of a bar that is bent by an angle over its length, and turned.
Positions bent(const Positions& rest, double angle) {
  const double length = 0.4, radius = length / std::max(angle, 1e-6);
  Positions x = rest;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const double along = rest(v, 0) / radius;
    x.row(v) = (Vec3(radius * std::sin(along), radius * (1 - std::cos(along)), rest(v, 2)) +
                rest(v, 1) * Vec3(-std::sin(along), std::cos(along), 0))
                   .transpose();
  }
  return (x * Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix().transpose()).eval();
}

// The matrix of A is exactly Z^T A Z for a body that has its rest shape, turned or not.
TEST(CoarseSystem, HasTheMatrixOfAOnItsMotions) {
  for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
    const Model model = build_model(bar(Corotated{1e4, 3e4}, held, Precision::double_precision, 2));
    CoarseSystem system;
    system.make(model);
    ASSERT_GE(system.columns(), 6);
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const Positions& x : {model.rest, Positions(model.rest * turn.transpose())}) {
      system.turn_to(x);
      Eigen::MatrixXd z = motions_of(model, system, x);
      const Eigen::MatrixXd expected = z.transpose() * test::dense_system(model) * z;
      EXPECT_LT((whole(system.constant(0)) - expected).norm(), 1e-9 * expected.norm()) << static_cast<int>(held);
    }
  }
}

// A rigid motion of the whole body costs no elastic energy in any shape: the matrix has its inertia alone.
TEST(CoarseSystem, DoesNotResistTurningInAnyShape) {
  const Model model = build_model(bar(Corotated{1e7, 3e7}, Held::nothing, Precision::double_precision, 3));
  CoarseSystem system;
  system.make(model);
  for (const double angle : {0.0, 1.5}) {
    const Positions x = bent(model.rest, angle);
    ASSERT_TRUE(system.turn_to(x));
    // Of each cluster: the turn, and the shift of its centre.
    const Vec3 axis = Vec3(2, -1, 1).normalized();
    Eigen::VectorXd y(system.columns());
    const Clusters clusters = make_clusters(model, wanted_clusters(model));
    for (int c = 0; c < clusters.count(); ++c) {
      y.segment<3>(6 * c) = axis.cross(x.row(clusters.center[c]).transpose());
      y.segment<3>(6 * c + 3) = axis;
    }
    const double resistance = y.dot(whole(system.hessian(0)) * y), by_constant = y.dot(whole(system.constant(0)) * y);
    double inertia = 0;
    for (int v = 0; v < model.vertices; ++v)
      inertia += model.mass[v] * axis.cross(x.row(v).transpose()).squaredNorm() / std::pow(model.time_step, 2);
    EXPECT_LT(resistance, 1.5 * inertia) << angle;  // the groups' moments are those of their rest shapes
    EXPECT_GT(resistance, 0.6 * inertia) << angle;
    EXPECT_GT(by_constant, 100 * inertia) << angle;
  }
}

TEST(SecondLevel, DirectionsAreSymmetricAndLeadDownhill) {
  for (const Material& material : test::all_materials()) {
    for (const Held held : {Held::nothing, Held::hard_end}) {
      const Model model = build_model(bar(material, held, Precision::double_precision, 2));
      const Positions x = shaken(model.rest, 0.02, 3);
      SecondLevel level;
      ASSERT_TRUE(level.begin(model, x));
      SolveScratch scratch;
      const auto direction = [&](const Positions& r) {
        Positions z(model.free, 3);
        solve_system(model, r, z, scratch);
        level.add_to(model, r, nullptr, z);
        return z;
      };
      for (unsigned seed = 1; seed <= 5; ++seed) {
        const Positions a = shaken(Positions::Zero(model.free, 3), 1, seed);
        const Positions b = shaken(Positions::Zero(model.free, 3), 1, seed + 100);
        const Positions of_a = direction(a), of_b = direction(b);
        EXPECT_GT(flat(a).dot(flat(of_a)), 0) << name_of(material);
        const double ab = flat(a).dot(flat(of_b)), ba = flat(b).dot(flat(of_a));
        const double scale = std::sqrt(flat(a).dot(flat(of_a)) * flat(b).dot(flat(of_b)));
        EXPECT_NEAR(ab, ba, 1e-9 * scale) << name_of(material);
      }
    }
  }
}

// Returns whether a cube has a second level. L resists its turning with 12 k h^2/(rho s^2) times its inertia, where it
// is s wide. resistance: this number.
bool has_second_level(BodyDescription body, double resistance) {
  const double k = build_model(body).stiffness[0].k, width = bounds_of(body.mesh.rest).extent().x();
  const double now = 12 * k * body.time_step * body.time_step / (body.density * width * width);
  const double factor = resistance / now;
  body.materials = {Corotated{1e4 * factor, 2e4 * factor}};
  const Model model = build_model(body);
  SecondLevel second;
  return second.begin(model, model.rest);
}

TEST(SecondLevel, IsLeftOutOfBodiesThatADoesNotKeepFromTurning) {
  BodyDescription body = cube(6, Corotated{1e4, 2e4});
  EXPECT_FALSE(has_second_level(body, 0.8));
  EXPECT_TRUE(has_second_level(body, 1.3));
  body.time_step = 1.0 / 300;
  EXPECT_FALSE(has_second_level(body, 0.8));
  EXPECT_TRUE(has_second_level(body, 1.3));
  body.mesh.rest *= 15;
  body.density = 100;
  EXPECT_FALSE(has_second_level(body, 0.8));
  EXPECT_TRUE(has_second_level(body, 1.3));
  body.handles = {{"corner", {0}}};
  EXPECT_FALSE(has_second_level(body, 0.8));
  EXPECT_TRUE(has_second_level(body, 1.3));
  body.integrator = Integrator::implicit_midpoint;  // half of L beside twice the inertia
  EXPECT_FALSE(has_second_level(body, 3.2));
  EXPECT_TRUE(has_second_level(body, 5.2));
}

// Drag resists turning as it should, so that it is no reason for a second level.
TEST(SecondLevel, IsNotWantedBecauseOfDamping) {
  BodyDescription body = cube(6, Corotated{1e4, 2e4});
  body.damping = body.time_step / 2;  // half of L is drag
  EXPECT_FALSE(has_second_level(body, 1.7));
  EXPECT_TRUE(has_second_level(body, 2.5));
  body.damping = 10 * body.time_step;
  EXPECT_FALSE(has_second_level(body, 4));
}

TEST(SecondLevel, IsWantedBecauseOfFibres) {
  BodyDescription body = cube(6, Corotated{1e4, 2e4});
  body.fibres = {Fibre{0, {1, 0, 0}}};
  EXPECT_FALSE(has_second_level(body, 0.5));
  body.fibres[0].kappa = 1e6;
  EXPECT_TRUE(has_second_level(body, 0.5));
}

// A slender bar twists about its long axis, where it has next to no inertia: L resists that with twice its inertia
// here, and turning about the other axes with a sixteenth.
TEST(SecondLevel, IsWantedByABarThatMayTwist) {
  BodyDescription body = cube(6, Corotated{1e4, 2e4});
  body.mesh.rest.col(0) *= 8;
  const double k = build_model(body).stiffness[0].k, width = 0.2;
  const double factor = 2 * body.density * width * width / (12 * k * body.time_step * body.time_step);
  body.materials = {Corotated{1e4 * factor, 2e4 * factor}};
  const Model model = build_model(body);
  SecondLevel second;
  EXPECT_TRUE(second.begin(model, model.rest));
}

// A rule that is asked to forget drops its pairs, then its second level, and then has nothing left to forget.
TEST(SecondLevel, IsForgottenAfterThePairs) {
  const Model model = build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::double_precision, 2));
  const StepInputs inputs = test::still_inputs(model);
  State state = rest_state(model);
  OpenWorkspace w, other;
  step(model, inputs, state, w);
  SystemInverse inverse;
  LbfgsRule rule(inverse);
  w.report.records.clear();
  rule.begin(model, inputs, w);
  const double both = rule.direction(model, inputs, w);
  EXPECT_TRUE(rule.forget());
  const double alone = rule.direction(model, inputs, w);
  EXPECT_FALSE(rule.forget());
  EXPECT_LT(both, 0);
  EXPECT_LT(alone, 0);
  EXPECT_NE(both, alone);
}

// Compares directions with contacts and friction with the dense inverse of B + K.
TEST(SecondLevel, ContactsAreAddedToBothLevels) {
  test::ContactScene scene(cube(3), {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5}},
                           Vec3(0, 0.0999, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.001, -0.05, 0);
  OpenWorkspace& w = scene.w;
  const Model& model = scene.model;
  w.prepare(model, scene.inputs.solver);
  begin_step(model, scene.inputs, scene.state, w);
  find_contacts_of(model, scene.inputs, w, w.current);
  find_stiff_directions(model, w.current.contacts, w.current.x, w.correction);
  ASSERT_GT(w.correction.wanted.size(), 10u);
  ASSERT_TRUE(w.second_level.begin(model, w.current.x));
  const int n = model.free;
  Eigen::MatrixXd inverse(3 * n, 3 * n);
  Positions r(n, 3), z(n, 3);
  for (int column = 0; column < 3 * n; ++column) {
    r.setZero();
    r.data()[column] = 1;
    solve_system(model, r, z, w.solve_scratch);
    w.second_level.add_to(model, r, nullptr, z);
    inverse.col(column) = flat(z);
  }
  w.correction.second = &w.second_level;
  const std::vector<StiffDirection> all = w.correction.wanted;
  // Between iterations some contacts go and others come. What is kept of those that stay must serve as if it were new.
  for (const auto& [first, step] : {std::pair(0u, 1u), {1u, 3u}, {0u, 2u}, {0u, 1u}}) {
    w.correction.wanted.clear();
    Eigen::MatrixXd system = inverse.inverse();
    for (std::size_t i = first; i < all.size(); i += step) {
      w.correction.wanted.push_back(all[i]);
      Positions along = Positions::Zero(n, 3);
      all[i].add(1, along);
      system += all[i].stiffness * flat(along) * flat(along).transpose();
    }
    r = shaken(Positions::Zero(n, 3), 1, 2);
    const Eigen::VectorXd wanted = system.ldlt().solve(flat(r));
    apply_inverse(model, {}, w.correction, w.solve_scratch, r, z);
    EXPECT_LT((flat(z) - wanted).norm(), 1e-3 * wanted.norm()) << first << " " << step;
  }
}

// A straight motion by which a body turns becomes that turn, and keeps its lengths.
TEST(Turning, MakesTurnsOfStraightMotions) {
  BodyDescription body = bar(Corotated{1e8, 3e8}, Held::nothing, Precision::double_precision, 3);
  const Model model = build_model(body);
  CoarseSystem system;
  system.make(model);
  Turning turning;
  SolveScratch scratch;
  Vec3 center = Vec3::Zero();
  for (int v = 0; v < model.vertices; ++v) center += model.mass[v] / model.total_mass * model.rest.row(v).transpose();
  const double angle = 0.3;
  const Vec3 axis = Vec3(1, 1, 3).normalized();
  Positions motion(model.vertices, 3), correction;
  for (int v = 0; v < model.vertices; ++v)
    motion.row(v) = (angle * axis.cross(model.rest.row(v).transpose() - center)).transpose();
  turning.take_tangent(system, model.rest, motion);
  EXPECT_GT(turning.energy(), 0);
  turning.correct(model, system, model.rest, scratch, correction);
  const Mat3 turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  const Positions turned =
      ((model.rest.rowwise() - center.transpose()) * turn.transpose()).rowwise() + center.transpose();
  const Positions reached = model.rest + motion + correction;
  EXPECT_LT((reached - turned).rowwise().norm().maxCoeff(),
            1e-3 * (model.rest + motion - turned).rowwise().norm().maxCoeff());
}

// Backward Euler turns a free rigid body by theta' with tan theta' = sin theta / (2 - cos theta) after a step by theta.
TEST(Turning, FreeBodiesLoseTheAngularMomentumThatBackwardEulerTakes) {
  for (const Material& material :
       {Material(Corotated{4e5, 2e6}), Material(NeoHookean{4e6, 2e7}), Material(StableNeoHookean{4e8, 2e9})}) {
    BodyDescription body = cube(4, material);
    body.precision = Precision::single_precision;
    const Model model = build_model(body);
    StepInputs inputs = test::still_inputs(model);
    inputs.gravity.setZero();
    State state = rest_state(model);
    constexpr double speed = 6;  // [rad/s]
    for (int v = 0; v < model.vertices; ++v)
      state.v.row(v) = (speed * Vec3::UnitY().cross(model.rest.row(v).transpose())).transpose();
    const auto momentum = [&] {
      double sum = 0;
      for (int v = 0; v < model.vertices; ++v)
        sum += model.mass[v] * Vec3(state.x.row(v)).cross(Vec3(state.v.row(v))).y();
      return sum;
    };
    const double before = momentum();
    double angle = 0, expected = 0;
    OpenWorkspace w;
    for (int frame = 0; frame < 30; ++frame) {
      step(model, inputs, state, w);
      angle = frame == 0 ? std::atan(speed * model.time_step) : std::atan2(std::sin(angle), 2 - std::cos(angle));
      expected = std::sin(angle) / (speed * model.time_step);
    }
    EXPECT_NEAR(momentum() / before, expected, 0.01 * expected) << name_of(material);
  }
}

// Makes a stiff bar that hangs on a hinge, an edge of its end.
Model bar_on_a_hinge() {
  BodyDescription body = bar(Corotated{4e8, 1.6e9}, Held::nothing, Precision::single_precision, 2);
  Handle hinge{"hinge", {}, 0.0};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, 0) < 1e-9 && body.mesh.rest(v, 1) < 1e-9) hinge.vertices.push_back(v);
  }
  body.handles = {hinge};
  return build_model(body);
}

// The paper's matrix leaves a stiff bar where it is, at an error of equation 12 that looks small.
TEST(MotionError, SeesABodyThatDoesNotTurn) {
  const Model model = bar_on_a_hinge();
  for (const int levels : {1, 2}) {
    StepInputs inputs = test::still_inputs(model);
    inputs.solver.levels = levels;
    State state = rest_state(model);
    OpenWorkspace w, scratch;
    for (int frame = 0; frame < 3; ++frame) step(model, inputs, state, w);
    const State before = state;
    const StepReport& report = step(model, inputs, state, w);
    Reference reference(model);
    const auto [error, motion] = reference.step_errors(model, inputs, before, state, scratch);
    EXPECT_LT(error.value_or(0), 1e-2);
    if (levels == 1) {
      EXPECT_GT(motion, 0.5);
      EXPECT_GT(report.motion_estimate, 0.1);
      EXPECT_TRUE(is_unsolved(report));
    } else {
      EXPECT_LT(motion, 0.01);
      EXPECT_FALSE(is_unsolved(report));
    }
  }
}

// Directions that resist turning hardly move the bar, and would foretell that next to nothing is left.
TEST(MotionError, OfABodyThatDoesNotTurnCountsTheWayAheadByAQuarter) {
  const Model model = bar_on_a_hinge();
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.levels = 1;
  State state = rest_state(model);
  OpenWorkspace w;
  for (int frame = 0; frame < 3; ++frame) {
    const Positions q = state.x;
    const double estimate = step(model, inputs, state, w).motion_estimate, ahead = motion_ahead(model, inputs, q, w);
    EXPECT_GT(w.lengths.left(0), 0);
    EXPECT_GT(ahead, 0.1);
    EXPECT_NEAR(estimate, ahead / 4, 1e-9 * ahead) << frame;
  }
}

// Equation 12 alone would end these steps after a few iterations, at the errors of motion of the test before.
TEST(MotionError, IsWhatTheTargetOfAStepCountsToo) {
  const Model model = bar_on_a_hinge();
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.levels = 1;
  inputs.solver.iterations = 1000;
  inputs.solver.target_error = 1e-2;
  State state = rest_state(model);
  OpenWorkspace w, scratch;
  for (int frame = 0; frame < 3; ++frame) {
    const State before = state;
    const StepReport& report = step(model, inputs, state, w);
    EXPECT_EQ(report.stop_reason, StopReason::target_error);
    Reference reference(model);
    EXPECT_LT(reference.step_errors(model, inputs, before, state, scratch).motion, 0.05) << frame;
  }
}

// A ball that slides onto rough ground rolls with 5/7 of its speed, less what its squashing takes: as fast as the ball
// whose steps are solved.
TEST(SecondLevel, ABallRolls) {
  for (const double young : {1e6, 1e8}) {
    BodyDescription body = cube(4, StableNeoHookean{young / 2.9 * 4 / 3, young / 2.9 * 9 + young / 2.9 * 5 / 6});
    for (Eigen::Index v = 0; v < body.mesh.rest.rows(); ++v) {  // the cube's shells become spheres
      const Vec3 at = body.mesh.rest.row(v).transpose();
      if (at.norm() > 0) body.mesh.rest.row(v) = (at.cwiseAbs().maxCoeff() / at.norm() * at).transpose();
    }
    body.precision = Precision::single_precision;
    double speeds[2];
    for (const bool solved : {false, true}) {
      test::ContactScene scene(body, {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5}},
                               Vec3(0, 0.1001, 0));
      if (solved) scene.inputs.solver.iterations = 200;
      scene.state.v.rowwise() = Eigen::RowVector3d(1, 0, 0);
      for (int frame = 0; frame < 12; ++frame) ASSERT_FALSE(scene.step().failed);
      double& speed = speeds[solved ? 1 : 0] = 0;
      for (int v = 0; v < scene.model.vertices; ++v)
        speed += scene.model.mass[v] / scene.model.total_mass * scene.state.v(v, 0);
    }
    EXPECT_GT(speeds[1], 0.5) << young;
    EXPECT_NEAR(speeds[0], speeds[1], 0.1) << young;  // it has 125 vertices
    EXPECT_GT(speeds[0], 0.55) << young;              // 0.03 with one level
    EXPECT_LT(speeds[0], 0.8) << young;
  }
}

}  // namespace second_level_test
}  // namespace supple
