// Tests vertex block descent and ADMM: colours, the move of a vertex against the assembled Hessian, the local step
// against the condition that defines it, and their bits on several threads.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "baselines/element_corner.h"
#include "baselines/element_proximal.h"
#include "baselines/make_rule.h"
#include "baselines/vertex_blocks.h"
#include "sim/model/element_view.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/hessian_matrix.h"
#include "sim/solver/objective.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/deformations.h"

namespace supple {
namespace local_methods_test {

using test::Held;

// Makes a bar of which all is in use: fibres, springs beside the tetrahedra, two regions, soft handles and damping.
BodyDescription rich_bar(const Material& material, Integrator integrator) {
  BodyDescription body = test::bar(material, Held::spring_end, Precision::double_precision, 2);
  body.integrator = integrator;
  body.damping = 0.01;
  body.materials = {material, StableNeoHookean{2e4, 4e4}};
  body.fibres = {{2e4, {1, 0, 0}}, {0, {1, 0, 0}}};
  body.mesh.regions.assign(body.mesh.tets.rows(), 0);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows() / 3; ++e) body.mesh.regions[e] = 1;
  body.springs = {{0, 5, 0.01, 300}, {2, 9, 0.02, 500}};  // stretched
  return body;
}

TEST(VertexColors, NoElementJoinsTwoVerticesOfOneColourAndEachIsThereForEachOfItsCorners) {
  const Model model = build_model(rich_bar(NeoHookean{1e4, 2e4}, Integrator::backward_euler));
  std::vector<int> color_of(model.free, -1);
  const std::vector<VertexColor> colors = vertex_colors(model);
  std::size_t lanes = 0;
  for (std::size_t c = 0; c < colors.size(); ++c) {
    for (const std::int32_t v : colors[c].vertices) {
      EXPECT_EQ(color_of[v], -1);
      color_of[v] = static_cast<int>(c);
    }
    EXPECT_EQ(std::set<std::int32_t>(colors[c].lane.begin(), colors[c].lane.end()).size(), colors[c].lane.size());
    lanes += colors[c].lane.size();
  }
  EXPECT_EQ(std::count(color_of.begin(), color_of.end(), -1), 0);
  std::size_t expected = 0;
  for_each_element(model, [&](const ElementView& element) {
    for (int a = 0; a < corners_of(element.kind); ++a) {
      if (element.corner[a] >= model.free) continue;
      ++expected;
      for (int b = 0; b < a; ++b) {
        if (element.corner[b] < model.free) {
          EXPECT_NE(color_of[element.corner[a]], color_of[element.corner[b]]);
        }
      }
    }
  });
  EXPECT_EQ(lanes, expected);
}

// Vertices of the first colour move before any other, so each makes the step of Newton's method in its coordinates.
TEST(VertexBlocks, TheFirstColourMovesByTheBlocksOfTheHessian) {
  for (const Material& material : test::all_materials()) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
      BodyDescription body = rich_bar(material, integrator);
      body.materials[1] = material;
      body.fibres.clear();  // theirs are projected
      const Model model = build_model(body);
      OpenWorkspace w;
      w.prepare(model, {});
      const State state = rest_state(model);
      StepInputs inputs = test::still_inputs(model);
      inputs.middle_targets = inputs.targets;
      begin_step(model, inputs, state, w);
      w.current.x.topRows(model.free) = test::shaken(w.current.x, 0.001, 3).topRows(model.free);
      const std::vector<VertexColor> colors = vertex_colors(model);
      const int touching = colors[0].vertices[0];
      Contact contact{ContactStencil::at_vertex(touching), {0}, Vec3(0.6, 0, 0.8), 0, 1e3, 0.01};
      contact.offset = contact.normal.dot(w.current.x.row(touching)) + 0.01;
      contact.friction = 3;
      contact.stick = 1e-3;
      contact.origin = w.current.x.row(touching).transpose() + Vec3(0, 0.02, 0);
      w.current.contacts = {contact};
      evaluate(model, w, w.current, Wanted::gradient);
      HessianMatrix hessian(model);
      const bool in_stretches =
          std::visit([]<class M>(const M&) { return M::needs != Needs::deformation_gradient; }, material);
      hessian.assemble(model, w, in_stretches);
      const Eigen::MatrixXd full = Eigen::MatrixXd(hessian.matrix()).selfadjointView<Eigen::Lower>();
      VertexBlockRule rule(model, false);
      EXPECT_LT(rule.direction(model, inputs, w), 0);
      for (const std::int32_t v : colors[0].vertices) {
        const Vec3 expected = -full.block<3, 3>(3 * v, 3 * v).ldlt().solve(Vec3(w.current.gradient.row(v)));
        EXPECT_LT((w.direction.row(v).transpose() - expected).norm(), 1e-9 * expected.norm()) << name_of(material);
      }
    }
  }
}

// At large deformations blocks are projected or not, each by itself, and both are known by the element's own Hessian.
TEST(VertexBlocks, ABlockIsTheHessiansWhereThatIsDefiniteAndElseTheProjectedOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> large(-0.9, 0.9);
  const double rest[4][3] = {{0.1, 0.2, -0.1}, {1.1, 0.3, 0}, {0.2, 1.1, 0.1}, {0, 0.1, 0.9}};
  double x[4][3], field[Tetrahedron::fields], force[3][3], raw[45], projected[45];
  Tetrahedron::fill(rest, field);
  const Fibre fibre{2e4, {0.6, 0, 0.8}};
  int indefinite = 0;
  for (const Material& material : test::all_materials()) {
    for (int trial = 0; trial < 40; ++trial) {
      for (int c = 0; c < 4; ++c) {
        for (int i = 0; i < 3; ++i) x[c][i] = rest[c][i] + large(random);
      }
      std::visit(
          [&]<class M>(const M& m) {
            const TetrahedronFormula<M, false> formula(m, nullptr);
            const CornerDerivatives<double> corner = tetrahedron_corner(m, nullptr, x, field);
            formula.energy(x, field, force);
            formula.stiffness(x, field, false, raw);
            formula.stiffness(x, field, true, projected);
            Mat3 block;
            block << raw[0], raw[1], raw[3], raw[1], raw[2], raw[4], raw[3], raw[4], raw[5];
            const bool definite = block.determinant() >= 0 && block.topLeftCorner<2, 2>().determinant() >= 0 &&
                                  block(0, 0) >= 0 && M::needs == Needs::deformation_gradient;
            indefinite += !definite;
            const double scale = std::max(block.norm(), 1.0);
            for (int n = 0; n < 6; ++n)
              EXPECT_NEAR(corner.block[n], definite ? raw[n] : projected[n], 1e-6 * scale) << M::name;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(corner.force[c], force[0][c], 1e-9 * scale) << M::name;
            // Fibres add the same, whatever the material does.
            const TetrahedronFormula<M, true> with_fibre(m, &fibre);
            const CornerDerivatives<double> fibred = tetrahedron_corner(m, &fibre, x, field);
            double more[3][3], added[45];
            with_fibre.energy(x, field, more);
            with_fibre.stiffness(x, field, true, added);
            for (int n = 0; n < 6; ++n)
              EXPECT_NEAR(fibred.block[n] - corner.block[n], added[n] - projected[n], 1e-9 * scale) << M::name;
            for (int c = 0; c < 3; ++c)
              EXPECT_NEAR(fibred.force[c] - corner.force[c], more[0][c] - force[0][c], 1e-9 * scale) << M::name;
          },
          material);
    }
  }
  EXPECT_GT(indefinite, 20);
}

// The local step's z is where psi(z) + k/2 |z - (F + u)|^2 has no slope: P(z) = k (F + u - z), which is k times the new
// multipliers.
TEST(Admm, MultipliersAfterTheLocalStepAreStresses) {
  const double k = 3e4;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> small(-0.15, 0.15);
  double x[4][3], field[Tetrahedron::fields], u[most_multipliers], force[3][3];
  const double rest[4][3] = {{0.1, 0.2, -0.1}, {1.1, 0.3, 0}, {0.2, 1.1, 0.1}, {0, 0.1, 0.9}};
  Tetrahedron::fill(rest, field);
  for (const Material& material : test::all_materials()) {
    for (int trial = 0; trial < 20; ++trial) {
      for (int c = 0; c < 4; ++c) {
        for (int i = 0; i < 3; ++i) x[c][i] = rest[c][i] + small(random);
      }
      for (double& number : u) number = 0.5 * small(random);
      const Matrix3<double> f = deformation_gradient(x, field);
      Matrix3<double> z, stress;
      for (int i = 0; i < 9; ++i) z.m[i] = f.m[i] + u[i];
      std::visit(
          [&](const auto& m) {
            tetrahedron_proximal(m, nullptr, k, x, field, false, u, force);
            for (int i = 0; i < 9; ++i) z.m[i] -= u[i];
            density_of(m, z, stress);
          },
          material);
      double wrong = 0, scale = 1e3;
      for (int i = 0; i < 9; ++i) {
        wrong = std::max(wrong, std::abs(stress.m[i] - k * u[i]));
        scale = std::max(scale, std::abs(stress.m[i]));
      }
      EXPECT_LT(wrong, 1e-4 * scale) << name_of(material);
    }
  }
}

TEST(Admm, SpringsAndFibresHaveTheirLocalStepInClosedForm) {
  const double x[2][3] = {{0, 0, 0}, {0, 0.3, 0.4}}, field[2] = {0.2, 700};
  double u[most_multipliers] = {0, 0.03, 0.04}, force[1][3];
  spring_proximal(x, field, false, u, force);
  // |d + u| = 0.55; the length in the middle between that and the rest length is 0.375, and 0.55 - 0.375 = 0.175.
  EXPECT_NEAR(u[1], 0.175 * 0.6, 1e-14);
  EXPECT_NEAR(u[2], 0.175 * 0.8, 1e-14);
  EXPECT_NEAR(force[0][1], 700 * 0.6 * (0.5 - 0.375 + 0.175), 1e-11);
  EXPECT_NEAR(force[0][2], 700 * 0.8 * (0.5 - 0.375 + 0.175), 1e-11);
}

// At the minimum of g the multipliers settle at the stresses, and neither method leaves it.
TEST(LocalMethods, ReachTheMinimumOfABodyWithEverything) {
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    const Model model = build_model(rich_bar(NeoHookean{1e4, 2e4}, integrator));
    StepInputs inputs = test::still_inputs(model);
    inputs.middle_targets = inputs.targets;
    State start = rest_state(model);
    start.v.topRows(model.free).setConstant(0.5);
    const auto solved = [&](const Method& method) {
      const auto rule = make_rule(method, model);
      StepInputs own = inputs;
      own.solver = settings_of(method, own.solver);
      own.solver.iterations = 3000;
      State after = start;
      OpenWorkspace w;
      const StepReport& report = step(model, own, after, w, *rule);
      EXPECT_FALSE(report.failed) << name_of(method);
      return after.x;
    };
    const Positions newton = solved(Method::newton);
    for (const Method& method : {Method::admm, Method::vertex_block_descent,
                                 Method{.matrix = StartMatrix::vertex_blocks, .acceleration = Acceleration::none}})
      EXPECT_LT((solved(method) - newton).cwiseAbs().maxCoeff(), 1e-8 * model.size) << name_of(method);
  }
}

TEST(LocalMethods, HaveTheSameBitsOnAnyNumberOfThreads) {
  const Model model = build_model(test::bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 6));
  State start = rest_state(model);
  start.x.topRows(model.free) = test::shaken(start.x, 0.005, 1).topRows(model.free);
  for (const Method& method : {Method::admm, Method::vertex_block_descent}) {
    StepInputs inputs = test::still_inputs(model);
    inputs.solver = settings_of(method, inputs.solver);
    std::vector<std::uint64_t> hashes;
    for (const int count : {1, 2, 4}) {
      Threads threads(count);
      OpenWorkspace w;
      w.threads = &threads;
      State state = start;
      const auto rule = make_rule(method, model);
      (void)step(model, inputs, state, w, *rule);
      hashes.push_back(state_hash(model, state));
    }
    EXPECT_EQ(hashes[1], hashes[0]) << name_of(method);
    EXPECT_EQ(hashes[2], hashes[0]) << name_of(method);
  }
}

}  // namespace local_methods_test
}  // namespace supple
