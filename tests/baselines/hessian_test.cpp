// Tests second derivatives: elements and the assembled matrix against differences of the gradient, projections against
// a dense eigenvalue clamp, and the directions that are computed from them.
#include "sim/solver/hessian_matrix.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>

#include "base/error.h"
#include "baselines/figure_rules.h"
#include "baselines/make_rule.h"
#include "baselines/newton.h"
#include "baselines/system_matrix.h"
#include "geometry/triangles/surface_thickness.h"
#include "sim/model/element_view.h"
#include "sim/solver/first_iterate.h"
#include "support/bodies.h"
#include "support/contact_scene.h"
#include "support/deformations.h"

namespace supple {
namespace hessian_test {

using test::Held;

Eigen::MatrixXd full(const SparseMatrix& lower) {
  Eigen::MatrixXd dense = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
  return dense;
}

// Computes the Hessian of g by central differences of its gradient, in steps of `step`.
Eigen::MatrixXd by_differences(const Model& model, OpenWorkspace& w, double step) {
  const int count = 3 * model.free;
  Eigen::MatrixXd hessian(count, count);
  const Positions x = w.current.x;
  w.trial.contacts = w.current.contacts;
  for (int i = 0; i < count; ++i) {
    w.trial.x = x;
    w.trial.x.data()[i] += step;
    evaluate(model, w, w.trial, Wanted::gradient);
    const Positions plus = w.trial.gradient;
    w.trial.x.data()[i] -= 2 * step;
    evaluate(model, w, w.trial, Wanted::gradient);
    const Positions difference = (plus - w.trial.gradient) / (2 * step);
    hessian.col(i) = Eigen::Map<const Eigen::VectorXd>(difference.data(), count);
  }
  return 0.5 * (hessian + hessian.transpose());
}

// Makes one tetrahedron whose first vertex is held.
BodyDescription tetrahedron(const std::array<Vec3, 4>& corners, const Material& material) {
  BodyDescription body;
  body.name = "tetrahedron";
  body.mesh.rest.resize(4, 3);
  for (int v = 0; v < 4; ++v) body.mesh.rest.row(v) = corners[v].transpose();
  body.mesh.tets.resize(1, 4);
  body.mesh.tets << 0, 1, 2, 3;
  body.materials = {material};
  body.density = 1e-6;  // so low that inertia does not hide what the element does
  body.time_step = 1;
  body.handles = {{"corner", {0}, 0}};
  return body;
}

// Sets up one tetrahedron at a given deformation gradient.
struct OneTetrahedron {
  explicit OneTetrahedron(const Material& material, const Fibre& fibre = {}) {
    BodyDescription body =
        tetrahedron({Vec3(0.1, 0.2, -0.1), Vec3(1.1, 0.3, 0), Vec3(0.2, 1.1, 0.1), Vec3(0, 0.1, 0.9)}, material);
    if (fibre.kappa > 0) body.fibres = {fibre};
    model = build_model(body);
    w.prepare(model, {});
    begin_step(model, test::still_inputs(model), rest_state(model), w);
  }
  void deform(const Mat3& f) {
    const Vec3 corner = model.rest.row(3);
    for (int v = 0; v < 4; ++v) w.current.x.row(v) = (corner + f * (Vec3(model.rest.row(v)) - corner)).transpose();
  }
  Model model;
  OpenWorkspace w;
};

// A difference across a kink of a formula says nothing. The seams of materials have measure zero, and these kinds of
// deformation have no cancelling stretches.
TEST(Hessian, OfEveryMaterialIsTheDerivativeOfItsGradient) {
  std::mt19937 random(1);
  for (const Material& material : test::all_materials()) {
    for (const bool fibres : {false, true}) {
      OneTetrahedron subject(material, fibres ? Fibre{3e3, {0.6, 0, 0.8}} : Fibre{});
      HessianMatrix hessian(subject.model);
      double worst = 0;
      for (const test::Kind& kind : test::kinds) {
        if (std::string(kind.name) == "small" || std::string(kind.name) == "huge") continue;
        for (int i = 0; i < 20; ++i) {
          subject.deform(test::deformation(kind, random));
          hessian.assemble(subject.model, subject.w, false);
          const Eigen::MatrixXd exact = full(hessian.matrix());
          const Eigen::MatrixXd found = by_differences(subject.model, subject.w, 1e-6);
          const double finer = (found - by_differences(subject.model, subject.w, 3e-6)).norm();
          if (finer > 1e-5 * found.norm()) continue;  // a seam of the material lies within the step
          const double error = (exact - found).norm() / found.norm();
          worst = std::max(worst, error);
          EXPECT_LT(error, 1e-5) << name_of(material) << (fibres ? " with fibres, " : ", ") << kind.name;
        }
      }
      fmt::print("{:22} {} worst {:.1e}\n", name_of(material), fibres ? "with fibres" : "           ", worst);
    }
  }
}

TEST(Hessian, ProjectionIsTheNearestPositiveSemidefiniteMatrix) {
  std::mt19937 random(2);
  for (const Material& material : test::all_materials()) {
    // The clamp is that of the density's Hessian over F: with rest edges along the axes, F's entries are the corners'
    // own coordinates.
    const Model model =
        build_model(tetrahedron({Vec3(0, 0, 0), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, material));
    ElementMatrices raw, projected;
    const auto dense = [](const ElementMatrices& m) {
      Eigen::MatrixXd matrix(9, 9);
      for (int i = 0; i < 9; ++i) {
        for (int j = 0; j <= i; ++j) matrix(i, j) = matrix(j, i) = m.numbers[i * (i + 1) / 2 + j];
      }
      return matrix;
    };
    for (const test::Kind& kind : test::kinds) {
      for (int i = 0; i < 20; ++i) {
        const Mat3 f = test::deformation(kind, random);
        Positions x(4, 3);
        for (int v = 0; v < 4; ++v) x.row(v) = (f * Vec3(model.rest.row(v))).transpose();
        element_matrices(model, nullptr, x, false, raw);
        element_matrices(model, nullptr, x, true, projected);
        const Eigen::MatrixXd matrix = dense(raw);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
        const Eigen::MatrixXd clamped =
            eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
        EXPECT_LE((clamped - dense(projected)).norm(), 1e-9 * matrix.norm()) << name_of(material) << ", " << kind.name;
      }
    }
  }
}

TEST(Hessian, OfAWholeBodyIsTheDerivativeOfItsGradient) {
  for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
      BodyDescription body = test::bar(NeoHookean{1e4, 2e4}, held);
      body.integrator = integrator;
      body.damping = 0.01;
      body.fibres = {{2e4, {1, 0, 0}}};
      const Model model = build_model(body);
      OpenWorkspace w;
      w.prepare(model, {});
      const State state = rest_state(model);
      StepInputs inputs = test::still_inputs(model);
      inputs.middle_targets = inputs.targets;
      begin_step(model, inputs, state, w);
      w.current.x.topRows(model.free) = test::shaken(w.current.x, 0.01, 3).topRows(model.free);
      HessianMatrix hessian(model);
      hessian.assemble(model, w, false);
      const Eigen::MatrixXd found = by_differences(model, w, 1e-6);
      EXPECT_LT((full(hessian.matrix()) - found).norm(), 1e-6 * found.norm());
      Eigen::VectorXd v = Eigen::VectorXd::Random(3 * model.free), product(3 * model.free);
      hessian.multiply(v.data(), product.data());
      EXPECT_LT((product - full(hessian.matrix()) * v).norm(), 1e-12 * product.norm());
    }
  }
}

TEST(Hessian, OfSpringsAndContactsIsTheDerivativeOfTheGradient) {
  BodyDescription net = test::spring_net(4);
  net.surface.resize(1, 3);
  net.surface.row(0) << 0, 7, 12;  // no spring joins these
  const Model model = build_model(net);
  OpenWorkspace w;
  w.prepare(model, {});
  const State state = rest_state(model);
  const StepInputs inputs = test::still_inputs(model);
  begin_step(model, inputs, state, w);
  w.current.x = test::shaken(w.current.x, 0.02, 5);
  for (int v = 0; v < 5; ++v) {
    Contact contact{ContactStencil::at_vertex(v), {0}, Vec3(0.6, 0, 0.8), 0, 1e3, 0.01};
    contact.offset = contact.normal.dot(w.current.x.row(v)) + 0.01;  // the vertex lies inside the plane
    w.current.contacts.push_back(contact);
  }
  Contact face{{{model.surface(0, 0), model.surface(0, 1), model.surface(0, 2)}, {0.5, 0.3, 0.2}, 3, 3},
               {0},
               Vec3(0, 0.8, 0.6),
               0,
               2e3,
               0.01};
  std::sort(face.stencil.vertex.begin(), face.stencil.vertex.begin() + 3);
  while (face.stencil.free > 0 && face.stencil.vertex[face.stencil.free - 1] >= model.free) --face.stencil.free;
  ASSERT_GT(face.stencil.free, 1);
  face.offset = gap(face, w.current.x) + 0.01;
  w.current.contacts.push_back(face);
  HessianMatrix hessian(model);
  hessian.assemble(model, w, false);
  const Eigen::MatrixXd found = by_differences(model, w, 1e-7);
  EXPECT_LT((full(hessian.matrix()) - found).norm(), 1e-6 * found.norm());
  hessian.assemble(model, w, true);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(full(hessian.matrix()));
  EXPECT_GT(eigen.eigenvalues()[0], 0);
}

TEST(Hessian, SystemMatrixIsWhatTheModelHasFactored) {
  for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
    BodyDescription body = test::bar(Corotated{1e4, 2e4}, held);
    body.damping = 0.02;
    body.fibres = {{2e4, {0, 1, 0}}};
    const Model model = build_model(body);
    const SparseMatrix a = system_matrix_of(model);
    const Positions b = Positions::Random(model.free, 3);
    Positions x(model.free, 3);
    AlignedVector<double> scratch;
    model.factor.solve(b.data(), x.data(), scratch);
    EXPECT_LT((a * x - b).norm(), 1e-12 * b.norm());
    for (int v = 0; v < model.free; ++v) EXPECT_NEAR(a.coeff(v, v), model.diagonal[v], 1e-9 * model.diagonal[v]);
  }
}

// Holds a bar that is shaken and then stepped once by any method, each time from the same state.
struct ShakenBar {
  const Model model = build_model(test::bar(NeoHookean{2e4, 4e4}, Held::hard_end, Precision::double_precision, 2));
  StepInputs inputs = test::still_inputs(model);
  State before = rest_state(model);

  explicit ShakenBar(int iterations) {
    inputs.solver.iterations = iterations;
    before.x.topRows(model.free) = test::shaken(before.x, 0.01, 7).topRows(model.free);
  }
  struct Stepped {
    State after;
    StepReport report;
  };
  Stepped by_ours() const {
    State after = before;
    OpenWorkspace w;
    const StepReport report = step(model, inputs, after, w);
    return {after, report};
  }
  Stepped by(SearchRule& rule, const SolverSettings& settings) const {
    StepInputs own = inputs;
    own.solver = settings;
    if (rule.needs_gradient()) own.solver.line_search = LineSearch::armijo;
    State after = before;
    OpenWorkspace w;
    const StepReport report = step(model, own, after, w, rule);
    return {after, report};
  }
  Stepped by(const Method& method) const {
    const auto rule = make_rule(method, model);
    return by(*rule, settings_of(method, inputs.solver));
  }
};

// Given enough iterations, every method reaches the minimum that ours reaches.
TEST(Methods, AllReachTheMinimumOfOneStep) {
  ShakenBar bar(2000);
  bar.before.v.topRows(bar.model.free).setConstant(0.5);
  const ShakenBar::Stepped ours = bar.by_ours();
  const double lowest = ours.report.objective.back();
  for (const Method& method : compared_methods()) {
    const std::string name = name_of(method);
    const auto [after, report] = bar.by(method);
    ASSERT_FALSE(report.failed) << name;
    EXPECT_NEAR(report.objective.back(), lowest, 1e-9 * (report.objective.front() - lowest)) << name;
    EXPECT_LT((after.x - ours.after.x).cwiseAbs().maxCoeff(), 1e-6 * bar.model.size) << name;
    fmt::print("{:24} {:5} iterations, {:5} trials\n", name, report.iterations, report.line_search);
  }
}

TEST(Methods, RulesOfFiguresReachTheMinimumToo) {
  ShakenBar bar(2000);
  bar.before.v.topRows(bar.model.free).setConstant(0.5);
  const ShakenBar::Stepped ours = bar.by_ours();
  const double lowest = ours.report.objective.back();
  SolverSettings papers = bar.inputs.solver;
  papers.levels = 1;
  const auto hecht = make_hecht_rule(bar.model), paper = make_paper_rule(bar.model);
  for (const auto& [after, report] : {bar.by(*hecht, hecht_settings(papers)), bar.by(*paper, papers)}) {
    ASSERT_FALSE(report.failed);
    EXPECT_NEAR(report.objective.back(), lowest, 1e-9 * (report.objective.front() - lowest));
    EXPECT_LT((after.x - ours.after.x).cwiseAbs().maxCoeff(), 1e-6 * bar.model.size);
  }
}

// The recursion of lbfgs.cpp, which finds all inner products in one pass, is that of the paper up to round-off.
TEST(Methods, ThePapersRecursionMakesOurIterates) {
  ShakenBar bar(5);
  bar.inputs.solver.levels = 1;
  bar.inputs.solver.rounds = 1;
  bar.inputs.solver.elements = Precision::double_precision;
  const auto paper = make_paper_rule(bar.model);
  const ShakenBar::Stepped plain = bar.by(*paper, bar.inputs.solver), ours = bar.by_ours();
  EXPECT_GT(plain.report.iterations, 3);
  EXPECT_EQ(plain.report.iterations, ours.report.iterations);
  EXPECT_LT((plain.after.x - ours.after.x).cwiseAbs().maxCoeff(), 1e-9 * bar.model.size);
}

TEST(Methods, ThePapersRuleMakesStepsInContact) {
  test::ContactScene scene(test::cube(3), {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.3}},
                           Vec3(0, 0.12, 0));
  scene.inputs.solver.levels = 1;
  const auto rule = make_paper_rule(scene.model);
  int touching = 0;
  for (int i = 0; i < 12; ++i) {
    const StepReport& report = step(scene.model, scene.inputs, scene.state, scene.w, *rule);
    ASSERT_FALSE(report.failed) << report.failure.what;
    touching += report.contacts.touching;
  }
  EXPECT_GT(touching, 0);
}

// Tests every combination in the table of forms, also those that compared_methods() does not contain, such as a matrix
// without acceleration.
TEST(Methods, EveryCombinationOfPartsReachesTheMinimum) {
  const ShakenBar bar(5000);
  const double lowest = bar.by_ours().report.objective.back();
  int count = 0;
  for (const MethodForm& form : method_forms) {
    for (const Preconditioner preconditioner : form.preconditioner) {
      for (const Acceleration acceleration : form.acceleration) {
        for (const Safeguard safeguard : form.safeguard) {
          const Method method{form.matrix,  form.linear, form.linear == LinearSolver::cg ? 7 : 0, 0, preconditioner,
                              acceleration, safeguard};
          const StepReport report = bar.by(method).report;
          ASSERT_FALSE(report.failed) << name_of(method);
          EXPECT_NEAR(report.objective.back(), lowest, 1e-8 * (report.objective.front() - lowest)) << name_of(method);
          ++count;
        }
      }
    }
  }
  EXPECT_EQ(count, 25);
}

TEST(Methods, PartsThatDoNotGoTogetherMakeNoRule) {
  const Model model = build_model(test::bar(NeoHookean{2e4, 4e4}, Held::hard_end, Precision::double_precision, 2));
  EXPECT_THROW((void)make_rule({.matrix = StartMatrix::identity, .linear = LinearSolver::cg}, model), InputError);
  EXPECT_THROW((void)make_rule(Method::lbfgs_from(StartMatrix::tangent), model), InputError);
  EXPECT_THROW((void)make_rule({.matrix = StartMatrix::hessian, .acceleration = Acceleration::none}, model),
               InputError);
  EXPECT_THROW((void)make_rule({.linear = LinearSolver::cg, .preconditioner = Preconditioner::jacobi}, model),
               InputError);
}

TEST(Methods, NewtonConvergesQuadratically) {
  const Model model = build_model(test::bar(NeoHookean{2e4, 4e4}, Held::hard_end, Precision::double_precision, 2));
  StepInputs inputs = test::still_inputs(model);
  inputs.solver = settings_of(Method::newton, inputs.solver);
  inputs.solver.iterations = 30;
  State state = rest_state(model);
  state.v.topRows(model.free).setConstant(0.3);
  OpenWorkspace w;
  const auto rule = make_rule(Method::newton, model);
  const StepReport& report = step(model, inputs, state, w, *rule);
  EXPECT_LE(report.iterations, 9);
  EXPECT_EQ(report.stop_reason, StopReason::round_off);
}

// Projection of elements whose sum is definite changes the matrix for nothing, so that Newton's method without it needs
// fewer iterations where compressed elements have negative eigenvalues. Where the Hessian itself is indefinite, both
// have the same direction.
TEST(Methods, ProjectionOnDemandIsNewtonWhereTheHessianIsDefinite) {
  BodyDescription body = test::bar(NeoHookean{2e4, 4e4}, Held::hard_end, Precision::double_precision, 2);
  const auto directions = [&](double squeezed, double time_step) {
    body.time_step = time_step;
    const Model model = build_model(body);
    const StepInputs inputs = test::still_inputs(model);
    OpenWorkspace w;
    w.prepare(model, inputs.solver);
    w.current.x = model.rest;
    w.current.x.col(1) *= squeezed;
    w.y = w.current.x;
    evaluate_start(model, inputs, w);
    std::array<Positions, 3> found;
    const std::array safeguards = {Safeguard::projection, Safeguard::on_demand, Safeguard::shift};
    for (std::size_t s = 0; s < 3; ++s) {
      NewtonRule rule(model, safeguards[s]);
      rule.begin(model, inputs, w);
      EXPECT_LT(rule.direction(model, inputs, w), 0);
      found[s] = w.direction;
    }
    return found;
  };
  const auto definite = directions(0.8, 1e-3);  // the inertia of a short step outweighs the elements
  EXPECT_TRUE(definite[1] == definite[2]) << "a shift of 0 is the Hessian as it is";
  const auto indefinite = directions(0.3, 1);
  EXPECT_TRUE(indefinite[1] == indefinite[0]);
  EXPECT_FALSE(indefinite[1] == indefinite[2]);
}

TEST(LineSearch, RecordsWhatTheFullStepDoes) {
  const Model model = build_model(test::bar(NeoHookean{2e4, 4e4}, Held::hard_end, Precision::double_precision, 2));
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.iterations = 12;
  inputs.solver.rounds = 1;
  State state = rest_state(model);
  state.v.topRows(model.free) = test::shaken(state.v, 3, 9).topRows(model.free);
  OpenWorkspace w;
  const StepReport& report = step(model, inputs, state, w);
  ASSERT_GT(report.records.size(), 5u);
  EXPECT_GT(report.decrease, 0);
  for (const IterationRecord& record : report.records) {
    if (record.alpha == 0) continue;  // the step began again from the body's last position
    EXPECT_GT(record.alpha, 0);
    EXPECT_EQ(record.full.decreases, record.alpha == 1);
  }
}

}  // namespace hessian_test
}  // namespace supple
