// Tests the time step as a whole: derivatives of the objective, equivalences, conservation, determinism.
#include "sim/solver/step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "baselines/reference.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "support/allocation_counter.h"
#include "support/bodies.h"
#include "support/contact_scene.h"
#include "support/objective_checks.h"

namespace supple {
namespace step_test {

using test::bar;
using test::Held;
using test::still_inputs;

TEST(Objective, GradientIsTheDerivativeOfTheValueForEveryMaterialAndHandle) {
  for (const Material& material : test::all_materials()) {
    for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end})
      test::expect_derivative_of_objective(bar(material, held), std::string(name_of(material)));
  }
}

// Makes one step of Projective Dynamics as Bouaziz et al. 2014 write it, for as-rigid-as-possible elements: rotations
// by SVD, then a dense solve.
Positions local_global(const BodyDescription& body, const Positions& y, Positions x, int iterations) {
  const int n = static_cast<int>(x.rows());
  const double h = body.time_step, mu = std::get<AsRigidAsPossible>(body.materials[0]).mu;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    for (int k = 0; k < 4; ++k) mass[body.mesh.tets(e, k)] += body.density * tet_volume(body.mesh, e) / 4;
  }
  system.diagonal() = mass / (h * h);
  struct Element {
    Eigen::Matrix<double, 4, 3> gradient;
    double weight;
  };
  std::vector<Element> elements;
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) =
          (body.mesh.rest.row(body.mesh.tets(e, k + 1)) - body.mesh.rest.row(body.mesh.tets(e, 0))).transpose();
    Element element;
    element.gradient.bottomRows<3>() = edges.inverse();
    element.gradient.row(0) = -element.gradient.bottomRows<3>().colwise().sum();
    element.weight = 2 * mu * tet_volume(body.mesh, e);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        system(body.mesh.tets(e, a), body.mesh.tets(e, b)) +=
            element.weight * element.gradient.row(a).dot(element.gradient.row(b));
      }
    }
    elements.push_back(element);
  }
  std::vector<char> held(n, 0);
  for (const Handle& handle : body.handles) {
    for (const std::int32_t v : handle.vertices) held[v] = 1;
  }
  std::vector<int> free;
  for (int v = 0; v < n; ++v) {
    if (!held[v]) free.push_back(v);
  }
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::MatrixXd right = mass.asDiagonal() * Eigen::MatrixXd(y) / (h * h);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      Mat3 f = Mat3::Zero();
      for (int k = 0; k < 4; ++k) f += x.row(body.mesh.tets(e, k)).transpose() * elements[e].gradient.row(k);
      Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
      Mat3 sign = Mat3::Identity();
      sign(2, 2) = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
      const Mat3 rotation = svd.matrixU() * sign * svd.matrixV().transpose();
      for (int k = 0; k < 4; ++k)
        right.row(body.mesh.tets(e, k)) +=
            elements[e].weight * (rotation * elements[e].gradient.row(k).transpose()).transpose();
    }
    Eigen::MatrixXd reduced(free.size(), free.size()), reduced_right(free.size(), 3);
    for (std::size_t i = 0; i < free.size(); ++i) {
      reduced_right.row(i) = right.row(free[i]);
      for (int v = 0; v < n; ++v) {
        if (held[v]) reduced_right.row(i) -= system(free[i], v) * x.row(v);
      }
      for (std::size_t j = 0; j < free.size(); ++j) reduced(i, j) = system(free[i], free[j]);
    }
    const Eigen::MatrixXd solved = reduced.ldlt().solve(reduced_right);
    for (std::size_t i = 0; i < free.size(); ++i) x.row(free[i]) = solved.row(i);
  }
  return x;
}

TEST(Step, WithWindowZeroOnAsRigidAsPossibleEqualsLocalGlobalAndNeverRejectsATrial) {
  for (const Held held : {Held::nothing, Held::hard_end}) {
    const BodyDescription body = bar(AsRigidAsPossible{2e4}, held);
    const Model model = build_model(body);
    StepInputs inputs = still_inputs(model);
    inputs.solver.levels = 1;
    inputs.solver.history = 0;
    inputs.solver.rounds = 1;
    inputs.solver.elements = Precision::double_precision;
    // Without gravity, y leaves the handle where its target is, so that the first iterate is y itself.
    inputs.gravity.setZero();
    inputs.solver.armijo = 0.5;
    for (const int iterations : {1, 3, 10}) {
      inputs.solver.iterations = iterations;
      State state = rest_state(model);
      state.x = test::shaken(model.rest, 0.01, 1);
      state.v = test::shaken(Positions::Zero(model.vertices, 3), 0.4, 2);
      for (const Model::HandleVertex& held_vertex : model.handled) {  // a handle at rest, so that both start from y
        state.x.row(held_vertex.vertex) = model.rest.row(held_vertex.vertex);
        state.v.row(held_vertex.vertex).setZero();
      }
      OpenWorkspace w;
      w.prepare(model, inputs.solver);
      begin_step(model, inputs, state, w);
      const Positions y = in_input_order(model, w.y), start = in_input_order(model, w.current.x);
      const StepReport& report = step(model, inputs, state, w);
      EXPECT_EQ(report.line_search, iterations);
      const Positions expected = local_global(body, y, start, iterations);
      EXPECT_LT((in_input_order(model, state.x) - expected).cwiseAbs().maxCoeff(), 1e-12 * model.size);
    }
  }
}

TEST(Step, ABodyAtRestWithoutForcesStaysWhereItIs) {
  for (const Material& material : test::all_materials()) {
    for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
      const Model model = build_model(bar(material, Held::nothing, precision));
      StepInputs inputs = still_inputs(model);
      inputs.gravity.setZero();
      State state = rest_state(model);
      OpenWorkspace w;
      for (int frame = 0; frame < 1000; ++frame) step(model, inputs, state, w);
      EXPECT_LT((state.x - model.rest).cwiseAbs().maxCoeff(), 1e-12 * model.size) << name_of(material);
    }
  }
}

TEST(Step, FreeFlightKeepsMomentum) {
  for (const Material& material : test::all_materials()) {
    for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
      for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
        BodyDescription body = bar(material, Held::nothing, precision, 2);
        body.integrator = integrator;
        const Model model = build_model(body);
        StepInputs inputs = still_inputs(model);
        inputs.gravity.setZero();
        State state = rest_state(model);
        state.x = test::shaken(model.rest, 0.01, 1);
        state.v = test::shaken(Positions::Zero(model.vertices, 3), 1, 2);
        state.v.rowwise() += Eigen::RowVector3d(3, 1, -2);
        const auto momentum = [&] {
          Vec3 p = Vec3::Zero();
          for (int v = 0; v < model.vertices; ++v) p += model.mass[v] * state.v.row(v).transpose();
          return p;
        };
        OpenWorkspace w;
        for (int frame = 0; frame < 20; ++frame) {
          const Vec3 before = momentum();
          step(model, inputs, state, w);
          EXPECT_LT((momentum() - before).norm(), 1e-11 * before.norm()) << name_of(material) << " frame " << frame;
        }
      }
    }
  }
}

TEST(Step, GravityAloneIsFreeFall) {
  const Model model = build_model(bar(NeoHookean{1e4, 3e4}, Held::nothing, Precision::single_precision));
  const StepInputs inputs = still_inputs(model);
  State state = rest_state(model);
  OpenWorkspace w;
  const int frames = 30;
  for (int frame = 0; frame < frames; ++frame)
    EXPECT_LT(step(model, inputs, state, w).error_estimate, 0.1) << "round-off is not an error of the solution";
  // Backward Euler gives x_n = x_0 + g h^2 n (n + 1) / 2.
  const double h = model.time_step, fall = -9.81 * h * h * frames * (frames + 1) / 2;
  EXPECT_LT((state.x.col(1).array() - model.rest.col(1).array() - fall).abs().maxCoeff(), 1e-10);
}

// From y, a body that is soft for its load comes no nearer in ten iterations than it was where it hangs, and took twice
// as many evaluations there as moving.
TEST(Step, ASoftBodyThatHangsStillTakesNoLongerThanAMovingOne) {
  BodyDescription body = bar(Polynomial{1e3}, Held::hard_end, Precision::single_precision, 2);
  const Model model = build_model(body);
  for (const int levels : {1, 2}) {
    StepInputs inputs = still_inputs(model);
    inputs.solver.levels = levels;
    State state = rest_state(model);
    OpenWorkspace w;
    double trials[2] = {0, 0};  // of the first steps, and of the last
    for (int frame = 0; frame < 900; ++frame) {
      ASSERT_FALSE(step(model, inputs, state, w).failed);
      if (frame < 60) trials[0] += w.report.line_search;
      if (frame >= 840) trials[1] += w.report.line_search;
    }
    EXPECT_LT(state.v.rowwise().norm().maxCoeff(), 1e-3) << "it hangs";
    EXPECT_GT(trials[0], 60 * 15) << "it is soft";
    EXPECT_LT(trials[1], 1.2 * trials[0]);
    EXPECT_LT(w.report.error_estimate, 1e-6);
  }
}

// Equation 12 divides by what there is to gain, and near rest that is round-off.
TEST(Step, ABodyThatComesToRestOnTheGroundHasNoError) {
  for (const Material& material : {Material(Corotated{1.07e4, 4.3e4}), Material(NeoHookean{1.07e4, 4.3e4})}) {
    BodyDescription body = test::cube(2, material);
    body.precision = Precision::single_precision;
    test::ContactScene scene(body, {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0})}}, Vec3(0, 0.1, 0));
    int slow = 0;
    for (int frame = 0; frame < 150; ++frame) {
      const StepReport& report = scene.step();
      if (scene.fastest() > 1e-5) continue;
      ++slow;
      EXPECT_LT(report.error_estimate, 0.1) << name_of(material) << ", frame " << frame;
    }
    EXPECT_GT(slow, 50);
  }
}

TEST(Step, ConvergesToAnErrorOf1e12WithoutStalling) {
  for (const Material& material : test::all_materials()) {
    for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
      const Model model = build_model(bar(material, Held::hard_end, precision, 2));
      StepInputs inputs = still_inputs(model);
      const State before = test::moving_state(model, inputs, 5);
      inputs.solver.iterations = 2000;
      State state = before;
      OpenWorkspace w, reference;
      const StepReport& report = step(model, inputs, state, w);
      ASSERT_FALSE(report.failed);
      EXPECT_EQ(report.stop_reason, StopReason::round_off)
          << name_of(material) << ": " << name_of(report.stop_reason) << " after " << report.iterations;
      EXPECT_LT(Reference(model).step_error(model, inputs, before, state, reference).value_or(1), 1e-12)
          << name_of(material);
    }
  }
}

TEST(Step, EndsWhereABudgetEndedAnEarlierOne) {
  const Model model = build_model(bar(NeoHookean{1e5, 4e5}, Held::hard_end, Precision::single_precision, 3));
  StepInputs inputs = still_inputs(model);
  inputs.solver.rounds = 1;
  const State before = test::moving_state(model, inputs, 5);
  const auto stepped = [&](int iterations, const std::optional<BudgetCuts>& cuts) {
    inputs.solver.iterations = iterations;
    inputs.repeated_cuts = cuts;
    State state = before;
    OpenWorkspace w;
    const StepReport& report = step(model, inputs, state, w);
    EXPECT_EQ(report.cuts, cuts.value_or(BudgetCuts{}));
    EXPECT_EQ(report.stop_reason, cuts ? StopReason::budget : StopReason::iterations);
    return state;
  };
  for (const int iterations : {4, 9, 15})  // steps of fewer iterations evaluate elements in double precision alone
    EXPECT_EQ(stepped(40, BudgetCuts{{iterations, -1}}).x, stepped(iterations, std::nullopt).x) << iterations;
}

TEST(Step, DoesNotRejectTrialsForTheRoundOffOfPositions) {
  // The body is a stiff bar two metres from the origin, swung until it hangs still: its positions are rounded to 4e-16
  // m, which strains its small elements visibly in g.
  BodyDescription body = bar(NeoHookean{1e6, 1e6}, Held::hard_end, Precision::single_precision, 3);
  body.mesh.rest.rowwise() += Eigen::RowVector3d(1.2, 1.2, 1.2);
  const Model model = build_model([&] {
    BodyDescription moved = body;
    moved.handles[0].vertices.clear();
    for (std::int32_t v = 0; v < moved.mesh.rest.rows(); ++v) {
      if (moved.mesh.rest(v, 0) < 1.2 + 1e-9) moved.handles[0].vertices.push_back(v);
    }
    return moved;
  }());
  StepInputs inputs = still_inputs(model);
  inputs.solver.iterations = 200;
  State state = rest_state(model);
  OpenWorkspace w;
  int trials = 0, iterations = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const StepReport& report = step(model, inputs, state, w);
    EXPECT_NE(report.stop_reason, StopReason::line_search_failed) << "frame " << frame;
    trials += report.line_search;
    iterations += report.iterations;
  }
  EXPECT_LT(trials, 1.1 * iterations);
}

TEST(Step, IsNeverWorseThanStaying) {
  for (const Material& material : test::all_materials()) {
    const Model model = build_model(bar(material, Held::hard_end, Precision::single_precision));
    StepInputs inputs = still_inputs(model);
    inputs.solver.iterations = 1;  // deliberately too few
    State state = rest_state(model);
    state.x.topRows(model.free) = test::shaken(model.rest, 0.05, 3).topRows(model.free);
    OpenWorkspace w;
    for (int frame = 0; frame < 60; ++frame) {
      const State before = state;
      step(model, inputs, state, w);
      const auto [staying, change] = test::against_staying(model, inputs, before, state);
      EXPECT_LE(change, 1e-12 * staying) << name_of(material) << " frame " << frame;
    }
  }
}

TEST(Step, DoesNotDependOnTheNumberOfThreads) {
  const Model model = build_model(
      bar(Polynomial{4e4}, Held::hard_end, Precision::single_precision, 8));  // 2,900 vertices: work is shared
  StepInputs inputs = still_inputs(model);
  inputs.targets.col(2).array() += 0.02;
  std::vector<std::uint64_t> hashes;
  for (const int count : {1, 2, 4}) {
    Threads threads(count);
    State state = rest_state(model);
    OpenWorkspace w;
    w.threads = &threads;
    for (int frame = 0; frame < 5; ++frame) step(model, inputs, state, w);
    hashes.push_back(state_hash(model, state));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(Step, AllocatesNothingOnceTheWorkspaceIsPrepared) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer owns malloc";
#endif
  const Model model = build_model(bar(Corotated{1e4, 3e4}, Held::spring_end, Precision::single_precision, 8));
  const StepInputs inputs = still_inputs(model);
  Threads threads(2);
  State state = rest_state(model);
  OpenWorkspace w;
  w.threads = &threads;
  step(model, inputs, state, w);
  const long before = test::allocations();
  for (int frame = 0; frame < 3; ++frame) step(model, inputs, state, w);
  EXPECT_EQ(test::allocations() - before, 0);
}

TEST(Step, WithoutLineSearchReportsTheVertexWhenTheBodyFliesApart) {
  const Model model = build_model(bar(Polynomial{1e5}, Held::hard_end, Precision::single_precision));
  StepInputs inputs = still_inputs(model);
  inputs.solver.line_search = LineSearch::none;
  inputs.solver.matrix = StartMatrix::system;  // the tangent's full steps bring this body back
  State state = rest_state(model);
  state.x.topRows(model.free) *= 6;
  OpenWorkspace w;
  StepReport report;
  State before = state;
  for (int frame = 0; frame < 200 && !report.failed; ++frame) {
    before = state;
    report = step(model, inputs, state, w);
  }
  ASSERT_TRUE(report.failed);
  EXPECT_GE(report.failure.vertex, 0);
  EXPECT_LT(report.failure.vertex, model.vertices);
  EXPECT_FALSE(report.failure.during.empty());
  EXPECT_TRUE(state.x == before.x && state.v == before.v) << "a failed step must leave the state alone";
}

TEST(Step, ErrorEstimateFollowsTheMeasuredError) {
  // The estimate is not a bound, but it must be of the error's size, so that it can be used to stop.
  const Model model = build_model(bar(NeoHookean{2e4, 8e4}, Held::hard_end, Precision::single_precision, 3));
  StepInputs inputs = still_inputs(model);
  State state = test::moving_state(model, inputs, 10);
  double log_ratio = 0;
  int count = 0, near = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const State before = state;
    OpenWorkspace w, reference;
    const StepReport& report = step(model, inputs, state, w);
    const auto error = Reference(model).step_error(model, inputs, before, state, reference);
    if (!error || *error <= 0 || report.error_estimate <= 0) continue;
    log_ratio += std::log10(report.error_estimate / *error);
    near += std::abs(std::log10(report.error_estimate / *error)) < std::log10(3.0);
    ++count;
  }
  ASSERT_GT(count, 10);
  EXPECT_LT(std::abs(log_ratio / count), 0.3);
  EXPECT_GE(near, 0.8 * count);
}

TEST(Step, AllHandlesArriveAtTheirTargets) {
  for (const Held held : {Held::hard_end, Held::spring_end}) {
    const Model model = build_model(bar(Corotated{1e3, 1e3}, held));
    StepInputs inputs = still_inputs(model);
    inputs.gravity.setZero();
    inputs.targets.col(0).array() += 0.05;
    State state = rest_state(model);
    OpenWorkspace w;
    for (int frame = 0; frame < 600; ++frame) step(model, inputs, state, w);
    for (std::size_t i = 0; i < model.handled.size(); ++i) {
      EXPECT_LT((state.x.row(model.handled[i].vertex) - inputs.targets.row(i)).norm(), 1e-6);
    }
  }
}

TEST(Step, StartsWithTheHandlesDepartureSpreadIntoTheBody) {
  // The handle jumps by a third of an element: y alone tears the elements beside it.
  const Model model = build_model(bar(Corotated{1e4, 3e4}, Held::hard_end, Precision::single_precision, 3));
  StepInputs inputs = still_inputs(model);
  inputs.targets.col(1).array() += 0.01;
  State state = rest_state(model);
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, state, w);
  evaluate(model, w, w.current, Wanted::value);
  const double at_y = w.current.g;
  const StepReport& report = step(model, inputs, state, w);
  EXPECT_LT(report.objective.front(), 0.5 * at_y);
}

}  // namespace step_test
}  // namespace supple
