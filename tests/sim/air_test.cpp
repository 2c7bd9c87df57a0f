// Tests the wind and the drag of the air against formulas: forces on plates, terminal speeds, light cloth in a storm.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/meshes/cloth.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "sim/air/air_forces.h"
#include "sim/air/wind_field.h"
#include "sim/model/joined_model.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/hessian_matrix.h"
#include "support/bodies.h"
#include "support/objective_checks.h"

namespace supple {
namespace air_test {

constexpr double area = 0.16;  // of the sheet [m^2]

// Returns a free sheet of 0.4 m by 0.4 m across the z axis. by_area: its mass [kg/m^2].
BodyDescription sheet(double by_area, double h = 1.0 / 30) {
  BodyDescription body = test::spring_net(8);
  const ClothMesh cloth = cloth_grid({0.4, 0.4}, {8, 8});
  body.surface = cloth.surface.triangles;
  for (double& mass : body.point_mass) mass *= by_area;
  body.time_step = h;
  return body;
}

Wind steady(const Vec3& velocity) {
  Wind wind;
  wind.velocity = velocity;
  return wind;
}

StepInputs inputs_of(const Model& model, const Wind& wind, const DragCoefficients& drag) {
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity.setZero();
  inputs.wind = wind;
  inputs.air = {{drag, {}}};
  return inputs;
}

// Returns the force of the air on a body that is at rest [N].
Vec3 force_at_rest(const Model& model, const StepInputs& inputs) {
  AirForces air;
  air.begin(model, inputs, model.rest, 0);
  Positions gradient = Positions::Zero(model.free, 3);
  air.add(model, nullptr, model.rest, nullptr, Positions::Zero(model.free, 3), &gradient);
  return -gradient.colwise().sum().transpose();
}

TEST(Wind, IsTheSameForTheSameSeedAndAnotherForAnother) {
  Wind wind = steady({5, 0, 1});
  wind.gusts = 0.5;
  const Vec3 place(1, 2, 3);
  const Vec3 here = WindField(wind).at(place, 4);
  EXPECT_EQ(WindField(wind).at(place, 4), here);
  wind.seed = 2;
  EXPECT_NE(WindField(wind).at(place, 4), here);
  wind.gusts = 0;
  EXPECT_EQ(WindField(wind).at(place, 4), wind.velocity);
}

TEST(Wind, HasTheMeanAndTheGustsThatWereAskedFor) {
  Wind wind = steady({8, 0, 0});
  wind.gusts = 0.3;
  const WindField field(wind);
  Vec3 mean = Vec3::Zero();
  double square = 0;
  constexpr int samples = 200000;
  for (int i = 0; i < samples; ++i) {
    const Vec3 gust = field.at({0.3, 0.1, -0.2}, 0.05 * i) - wind.velocity;
    mean += gust / samples;
    square += gust.squaredNorm() / samples;
  }
  EXPECT_LT(mean.norm(), 0.01 * wind.velocity.norm());
  EXPECT_NEAR(std::sqrt(square), 0.3 * 8, 0.02 * 0.3 * 8);
}

TEST(Wind, IsSmoothAndCompressesNoAir) {
  Wind wind = steady({8, 0, 0});
  wind.gusts = 0.3;
  const WindField field(wind);
  constexpr double d = 1e-4;
  double divergence = 0, largest = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 by = d * Vec3::Unit(k);
    const Vec3 slope = (field.at(by, 1) - field.at(-by, 1)) / (2 * d);
    divergence += slope[k];
    largest = std::max(largest, slope.norm());
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(std::abs(divergence), 1e-5 * largest);
  EXPECT_LT((field.at(Vec3::Zero(), 1 + d) - field.at(Vec3::Zero(), 1)).norm(), 100 * d);
}

TEST(Air, PushesAPlateAcrossTheWindByItsCoefficient) {
  const Model model = build_model(sheet(0.2));
  const Vec3 force = force_at_rest(model, inputs_of(model, steady({0, 0, 7}), {1.17, 0.5}));
  EXPECT_NEAR(force.z(), 1.17 * 1.2 * area * 49 / 2, 1e-12);
  EXPECT_LT(force.head<2>().norm(), 1e-12);
}

TEST(Air, PullsAPlateAlongTheWindByTheTangentialCoefficient) {
  const Model model = build_model(sheet(0.2));
  const Vec3 force = force_at_rest(model, inputs_of(model, steady({0, -7, 0}), {1.17, 0.02}));
  EXPECT_NEAR(force.y(), -0.02 * 1.2 * area * 49 / 2, 1e-12);
}

TEST(Air, PushesAPlateAtAnAngleAcrossItselfAlone) {
  const Model model = build_model(sheet(0.2));
  const Vec3 force = force_at_rest(model, inputs_of(model, steady({0, 5, 5}), {1, 0}));
  EXPECT_NEAR(force.z(), 1.2 * area * 25 / 2, 1e-12);
  EXPECT_LT(force.head<2>().norm(), 1e-12);
}

// A solid plate has the air on two sides and the drag of a sheet; here its thickness is a hundredth of its edge.
TEST(Air, PushesAThinSolidPlateAsItDoesASheet) {
  BodyDescription body;
  body.name = "plate";
  body.mesh = box_mesh(Vec3(1, 1, 0.01), Eigen::Vector3i(4, 4, 1));
  body.materials = {Corotated{1e4, 1e4}};
  const Model model = build_model(body);
  const Vec3 force = force_at_rest(model, inputs_of(model, steady({0, 0, 3}), {1.17, 0}));
  EXPECT_NEAR(force.z(), 1.17 * 1.2 * 9 / 2, 1e-9);
}

// Soft handles hold every vertex of a sheet, and their springs tell what the wind does to it. A silk of 60 g/m^2 in a
// storm would lose more than its speed in a step of the force at its start; held, it must feel the force whole.
TEST(Air, PushesAHeldSheetByTheWholeForceHoweverLightItIs) {
  for (const double by_area : {0.06, 0.5}) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
      BodyDescription body = sheet(by_area);
      body.integrator = integrator;
      body.damping = integrator == Integrator::implicit_midpoint ? 0.05 : 0;
      Handle all{"all", {}, 3000};
      for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) all.vertices.push_back(v);
      body.handles = {all};
      const Model model = build_model(body);
      StepInputs inputs = inputs_of(model, steady({0, 0, 40}), {1.17, 0});
      inputs.middle_targets = inputs.targets;
      inputs.solver.iterations = 50;
      State state = rest_state(model);
      OpenWorkspace w;
      Vec3 mean = Vec3::Zero();
      constexpr int steps = 200, counted = 100;
      for (int i = 0; i < steps; ++i) {
        ASSERT_FALSE(step(model, inputs, state, w).failed);
        if (i < steps - counted) continue;
        for (std::size_t k = 0; k < model.handled.size(); ++k)
          mean += 3000.0 / counted *
                  (state.x.row(model.handled[k].vertex) - inputs.targets.row(Eigen::Index(k))).transpose();
      }
      // The sheet bulges a little, so that its triangles are not all across the wind.
      const double plate = 1.17 * 1.2 * area * 40 * 40 / 2;
      EXPECT_NEAR(mean.z(), plate, 0.005 * plate) << by_area << ' ' << name_of(integrator);
    }
  }
}

TEST(Air, LetsASheetFallAtItsTerminalSpeed) {
  for (const double by_area : {0.06, 0.2}) {
    const Model model = build_model(sheet(by_area));
    StepInputs inputs = inputs_of(model, steady({0, 0, 0}), {1.17, 0.02});
    inputs.gravity = Vec3(0, 0, -9.81);
    const State state = test::moving_state(model, inputs, 300);
    const double terminal = std::sqrt(2 * by_area * area * 9.81 / (1.2 * 1.17 * area));
    for (int v = 0; v < model.free; ++v) EXPECT_NEAR(state.v(v, 2), -terminal, 1e-3 * terminal) << by_area;
  }
}

// A free sheet across the wind follows w_n' = w_n - k h |w_n'| w_n', and never turns around.
TEST(Air, CarriesALightFreeSheetAlongWithoutOvershooting) {
  const double by_area = 0.06, h = 1.0 / 30, k = 1.2 * 1.17 / (2 * by_area);
  const Model model = build_model(sheet(by_area, h));
  StepInputs inputs = inputs_of(model, steady({0, 0, 40}), {1.17, 0.02});
  inputs.solver.iterations = 30;
  EXPECT_GT(k * h * 40, 10);  // the force at the start of the step would throw the sheet back at twenty times the speed
  State state = rest_state(model);
  OpenWorkspace w;
  double beyond = -40;
  for (int i = 0; i < 60; ++i) {
    ASSERT_FALSE(step(model, inputs, state, w).failed);
    const double before = beyond;
    beyond = -(std::sqrt(1 + 4 * k * h * std::abs(before)) - 1) / (2 * k * h);
    for (int v = 0; v < model.free; ++v) EXPECT_NEAR(state.v(v, 2), 40 + beyond, 1e-3 * 40);
  }
}

TEST(Air, LeavesLightClothInAStormStable) {
  BodyDescription body = sheet(0.06);
  Handle edge{"edge", {}, 0};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, 0) < body.mesh.rest.col(0).minCoeff() + 1e-9) edge.vertices.push_back(v);
  }
  body.handles = {edge};
  for (Spring& spring : body.springs) spring.stiffness = 500;
  const Model model = build_model(body);
  Wind wind = steady({40, 0, 0});
  wind.gusts = 0.3;
  StepInputs inputs = inputs_of(model, wind, {1.17, 0.02});
  inputs.gravity = Vec3(0, -9.81, 0);
  State state = rest_state(model);
  OpenWorkspace w;
  double fastest = 0, trials = 0;
  for (int i = 0; i < 300; ++i) {
    const StepReport& report = step(model, inputs, state, w);
    ASSERT_FALSE(report.failed) << i;
    fastest = std::max(fastest, state.v.rowwise().norm().maxCoeff());
    trials += report.line_search;
    EXPECT_LT((state.x - model.rest).rowwise().norm().maxCoeff(), 1.5);
  }
  EXPECT_LT(fastest, 1.5 * 40 * 1.3);
  EXPECT_LT(trials / 300, 40);
}

TEST(Air, LetsASolidBallFallAtItsTerminalSpeed) {
  BodyDescription body;
  body.name = "ball";
  body.mesh = box_mesh(Vec3(0.2, 0.2, 0.2), Eigen::Vector3i(8, 8, 8));
  const Vec3 center = Vec3::Constant(0.1);
  double radius = 0.1;
  for (Eigen::Index v = 0; v < body.mesh.rest.rows(); ++v) {  // layers of the cube become layers of a ball
    const Vec3 from = body.mesh.rest.row(v).transpose() - center;
    const double layer = from.cwiseAbs().maxCoeff();
    if (layer > 0) body.mesh.rest.row(v) = (center + layer * from.normalized()).transpose();
  }
  body.materials = {Corotated{1e6, 1e6}};
  body.density = 50;
  const Model model = build_model(body);
  StepInputs inputs = inputs_of(model, steady({0, 0, 0}), {1.17, 0});
  inputs.gravity = Vec3(0, -9.81, 0);
  const State state = test::moving_state(model, inputs, 900);
  // Over a ball |cos|^3 has the integral pi R^2 as two half spheres of half of it each; a solid's triangles have half
  // of the coefficient, so that the ball has c_n / 2. Its mesh has less surface than the ball.
  const double drag = 1.17 / 2 * std::numbers::pi * radius * radius;
  const double terminal = std::sqrt(2 * model.total_mass * 9.81 / (1.2 * drag));
  EXPECT_NEAR(-state.v.col(1).mean(), terminal, 0.04 * terminal);
}

TEST(Air, HasForcesThatAreTheDerivativesOfItsEnergy) {
  Wind wind = steady({3, 1, 2});
  wind.gusts = 0.5;
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    BodyDescription body = sheet(0.1);
    body.integrator = integrator;
    test::expect_derivative_of_objective(body, "sheet", wind, {{{1.17, 0.3}, {}}});
    BodyDescription solid = test::bar(Corotated{1e4, 1e4}, test::Held::hard_end);
    solid.integrator = integrator;
    test::expect_derivative_of_objective(solid, "bar", wind, {{{1.17, 0.3}, {}}});
  }
}

TEST(Air, HasAHessianThatIsTheDerivativeOfItsForces) {
  const Model model = build_model(sheet(0.1));
  const StepInputs inputs = inputs_of(model, steady({3, 1, 2}), {1.17, 0.3});
  State state = rest_state(model);
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, state, w);
  w.current.x = test::shaken(model.rest, 0.02, 4);
  const Positions at = w.current.x;
  HessianMatrix hessian(model);
  hessian.assemble(model, w, false);
  const Positions way = test::shaken(Positions::Zero(model.free, 3), 1, 6);
  Positions expected(model.free, 3), found(model.free, 3);
  hessian.multiply(way.data(), expected.data());
  constexpr double d = 1e-6;
  w.current.x = at + d * way;
  evaluate(model, w, w.current, Wanted::gradient);
  found = w.current.gradient;
  w.current.x = at - d * way;
  evaluate(model, w, w.current, Wanted::gradient);
  found = (found - w.current.gradient) / (2 * d);
  EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
}

TEST(Air, ActsOnEachPartOfAJoinedModelAsOnThePartAlone) {
  const Model light = build_model(sheet(0.1)), heavy = build_model(sheet(1));
  const Model joined = join({&light, &heavy});
  Wind wind = steady({3, 1, 2});
  wind.gusts = 0.5;
  StepInputs inputs = inputs_of(light, wind, {1.17, 0.02});
  AirForces alone, together;
  alone.begin(light, inputs, light.rest, 0.5);
  inputs.air = {PartAir{}, inputs.air.front()};
  together.begin(joined, inputs, joined.rest, 0.5);
  Positions of_one = Positions::Zero(light.free, 3), of_both = Positions::Zero(joined.free, 3);
  alone.add(light, nullptr, light.rest, nullptr, of_one, &of_one);
  together.add(joined, nullptr, joined.rest, nullptr, of_both, &of_both);
  EXPECT_EQ(of_both.topRows(light.free).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(of_both.bottomRows(heavy.free), of_one);
}

TEST(Air, HasTheSameBitsOnAnyNumberOfThreads) {
  BodyDescription body = sheet(0.1);
  const ClothMesh cloth = cloth_grid({1, 1}, {60, 60});
  body.mesh.rest = cloth.surface.points;
  body.surface = cloth.surface.triangles;
  body.point_mass = vertex_areas(cloth.surface);
  body.springs.clear();
  for (const auto& [from, to] : cloth.edges)
    body.springs.push_back({from, to, (body.mesh.rest.row(from) - body.mesh.rest.row(to)).norm(), 50});
  const Model model = build_model(body);
  Wind wind = steady({3, 1, 2});
  wind.gusts = 0.5;
  const StepInputs inputs = inputs_of(model, wind, {1.17, 0.1});
  std::vector<std::uint64_t> hashes;
  for (const int count : {1, 2, 5}) {
    Threads threads(count);
    OpenWorkspace w;
    w.threads = &threads;
    State state = rest_state(model);
    for (int i = 0; i < 5; ++i) step(model, inputs, state, w);
    hashes.push_back(state_hash(model, state));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

}  // namespace air_test
}  // namespace supple
