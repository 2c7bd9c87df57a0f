// Tests gas in closed surfaces: its law, its forces and stiffness, solids under pressure against the closed form, and
// solvers that agree on balloons.
#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Geometry>

#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "geometry/meshes/cloth.h"
#include "geometry/tetrahedra/tetrahedralize.h"
#include "sim/air/enclosed_volume.h"
#include "sim/measures/energies.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/hessian_matrix.h"
#include "support/bodies.h"
#include "support/objective_checks.h"
#include "support/surfaces.h"

namespace supple {
namespace gas_test {

// Returns a body of springs along the edges of a surface, with 0.3 kg/m^2.
BodyDescription balloon(const TriMesh& surface, double stiffness) {
  BodyDescription body;
  body.name = "balloon";
  body.mesh.rest = surface.points;
  body.mesh.tets.resize(0, 4);
  body.surface = surface.triangles;
  body.precision = Precision::double_precision;
  for (const auto& t : surface.triangles.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = t[k], to = t[(k + 1) % 3];
      if (from < to)
        body.springs.push_back({from, to, (surface.points.row(from) - surface.points.row(to)).norm(), stiffness});
    }
  }
  body.point_mass = vertex_areas(surface);
  for (double& mass : body.point_mass) mass *= 0.3;
  return body;
}

BodyDescription sphere(double stiffness = 400) { return balloon(test::sphere_surface(0.2, 16, 9), stiffness); }

StepInputs inputs_of(const Model& model, double gauge, GasAmount amount) {
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity.setZero();
  inputs.air = {{{}, GasFilling{gauge, amount}}};
  return inputs;
}

double volume_of(const Model& model, const Positions& x) {
  return signed_volume(model.surface, 0, model.surface.rows(), x);
}

// Returns the gas' forces on all vertices at x, which the test takes as the body's start as well [N].
Positions forces_at(const Model& model, const StepInputs& inputs, const Positions& x) {
  AirForces air;
  air.begin(model, inputs, x, 0);
  Positions gradient = Positions::Zero(model.free, 3);
  air.add(model, nullptr, x, nullptr, Positions::Zero(model.free, 3), &gradient);
  return -gradient;
}

TEST(Gas, HasALawWhoseDerivativesAreThoseOfItsEnergy) {
  for (const GasAmount amount : {GasAmount::open, GasAmount::fixed}) {
    const GasLaw law({2000, amount}, 0.03);
    EXPECT_EQ(law.energy(0.03), 0);
    EXPECT_NEAR(law.gauge_pressure(0.03), 2000, 1e-9);
    for (const double volume : {-0.01, 0.001, 0.0015, 0.01, 0.03, 0.09}) {
      const double d = 1e-7;
      const double slope = (law.energy(volume + d) - law.energy(volume - d)) / (2 * d);
      EXPECT_NEAR(law.gauge_pressure(volume), -slope, 1e-4 * std::abs(slope)) << volume;
      const double curve = (law.gauge_pressure(volume - d) - law.gauge_pressure(volume + d)) / (2 * d);
      EXPECT_NEAR(law.stiffness(volume), curve, 1e-4 * std::abs(curve) + 1e-3) << volume;
      EXPECT_NEAR(law.energy_change(volume, d), law.energy(volume + d) - law.energy(volume), 1e-9) << volume;
    }
  }
  // At the pressure of the atmosphere a change of the volume by a billionth does work of second order alone.
  const GasLaw calm({0, GasAmount::fixed}, 1);
  EXPECT_NEAR(calm.energy_change(1, 1e-9) / (0.5 * atmospheric_pressure * 1e-18), 1, 1e-6);
}

// The test scales a box, and computes its volume, the area of a side and the pressure by itself.
TEST(Gas, PressesOnASideByPressureTimesArea) {
  const Model model = build_model(balloon(test::box_surface({0.1, 0.2, 0.3}), 100));
  for (const double scale : {0.8, 1.0, 1.5}) {
    const double rest_volume = 0.2 * 0.4 * 0.6, volume = rest_volume * scale * scale * scale;
    for (const GasAmount amount : {GasAmount::open, GasAmount::fixed}) {
      const double absolute = amount == GasAmount::open ? 3000 + 101325.0 : (3000 + 101325.0) * rest_volume / volume;
      const Positions x = scale * model.rest;
      const Positions force = forces_at(model, inputs_of(model, 3000, amount), x);
      double on_side = 0;
      for (int v = 0; v < model.free; ++v) {
        if (x(v, 0) > 0) on_side += force(v, 0);
      }
      const double side = 0.4 * 0.6 * scale * scale;
      EXPECT_NEAR(on_side, (absolute - 101325) * side, 1e-9 * absolute * side) << scale;
    }
  }
}

TEST(Gas, PressesOutwardsWhicheverWayTheTrianglesAreTurned) {
  const TriMesh box = test::box_surface({0.1, 0.2, 0.3});
  const Model model = build_model(balloon(box, 100)), turned = build_model(balloon(test::inside_out(box), 100));
  const StepInputs inputs = inputs_of(model, 3000, GasAmount::fixed);
  const Positions force = in_input_order(model, forces_at(model, inputs, model.rest));
  EXPECT_GT(force.cwiseProduct(box.points).sum(), 0);
  EXPECT_LT((in_input_order(turned, forces_at(turned, inputs, turned.rest)) - force).norm(), 1e-12 * force.norm());
}

TEST(Gas, HasNoNetForceAndNoNetTorque) {
  const Model model = build_model(sphere());
  for (const double away : {0.0, 1e4}) {
    const Positions x = test::shaken(model.rest, 0.02, 2).rowwise() + Eigen::RowVector3d(away, -away, away);
    const Positions force = forces_at(model, inputs_of(model, 3000, GasAmount::fixed), x);
    const double all = force.rowwise().norm().sum();
    Vec3 torque = Vec3::Zero();
    const Eigen::RowVector3d center = x.colwise().mean();
    for (int v = 0; v < model.free; ++v) torque += Vec3(x.row(v) - center).cross(Vec3(force.row(v)));
    EXPECT_LT(force.colwise().sum().norm(), 1e-13 * all * (1 + away)) << away;
    EXPECT_LT(torque.norm(), 1e-13 * all * (1 + away)) << away;
  }
}

TEST(Gas, HasForcesThatAreTheDerivativesOfItsEnergy) {
  for (const GasAmount amount : {GasAmount::open, GasAmount::fixed}) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
      BodyDescription body = sphere();
      body.integrator = integrator;
      test::expect_derivative_of_objective(body, "balloon", {}, {{{}, GasFilling{3000, amount}}});
      BodyDescription solid = test::bar(Corotated{1e4, 1e4}, test::Held::hard_end);
      solid.integrator = integrator;
      test::expect_derivative_of_objective(solid, "bar", {}, {{{}, GasFilling{3000, amount}}});
    }
  }
}

// Far from the origin, a change of the positions by a tenth of a micrometre keeps its digits.
TEST(Gas, HasDifferencesWithoutCancellation) {
  const Model model = build_model(sphere());
  const StepInputs inputs = inputs_of(model, 3000, GasAmount::open);
  constexpr double far = 1024, small = 0x1p-23;  // both exact, and so are the sums with coordinates that are cut off
  Positions near = model.rest;
  for (double& value : near.reshaped()) value = std::round(value * 0x1p20) * 0x1p-20;
  const Positions from = near.array() + far;
  Positions to = from;
  for (int v = 0; v < model.free; ++v) to.row(v) += small * Eigen::RowVector3d(v % 3, v % 5, v % 7);
  AirForces air;
  air.begin(model, inputs, from, 0);
  const Positions none = Positions::Zero(model.free, 3);
  const double change = air.add(model, nullptr, to, &from, none, nullptr).value;
  const double expected = -3000 * (volume_of(model, to.array() - far) - volume_of(model, near));
  EXPECT_NEAR(change / expected, 1, 1e-8);
}

TEST(Gas, HasAHessianThatIsTheDerivativeOfItsForces) {
  const Model model = build_model(sphere());
  const StepInputs inputs = inputs_of(model, 3000, GasAmount::fixed);
  const State state = rest_state(model);
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, state, w);
  const Positions at = test::shaken(model.rest, 0.01, 4);
  w.current.x = at;
  HessianMatrix hessian(model);
  hessian.assemble(model, w, false);
  const Positions way = test::shaken(Positions::Zero(model.free, 3), 1, 6);
  Positions expected(model.free, 3), u;
  hessian.multiply(way.data(), expected.data());
  const double stiffness = w.air.rank_one_share(model, 0, at, u);
  expected += stiffness * u.cwiseProduct(way).sum() * u;
  constexpr double d = 1e-6;
  w.current.x = at + d * way;
  evaluate(model, w, w.current, Wanted::gradient);
  Positions found = w.current.gradient;
  w.current.x = at - d * way;
  evaluate(model, w, w.current, Wanted::gradient);
  found = (found - w.current.gradient) / (2 * d);
  EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
}

// A cube of a corotated material under the outer pressure P shrinks by the same share s along all axes, where the
// stress (2 mu + 3 lambda) (s - 1) of the rest area balances -P s^2.
TEST(Gas, CompressesASolidCubeByTheClosedForm) {
  constexpr double mu = 2e4, lambda = 3e4, pressure = 1.5e4;
  BodyDescription body;
  body.name = "cube";
  body.mesh = box_mesh(Vec3(0.2, 0.2, 0.2), Eigen::Vector3i(3, 3, 3));
  body.materials = {Corotated{mu, lambda}};
  body.precision = Precision::double_precision;
  const Model model = build_model(body);
  StepInputs inputs = inputs_of(model, -pressure, GasAmount::open);
  inputs.solver.iterations = 40;
  const State state = test::moving_state(model, inputs, 300);
  const double k = 2 * mu + 3 * lambda;
  const double share = (std::sqrt(k * k + 4 * pressure * k) - k) / (2 * pressure);
  EXPECT_LT(share, 0.95);
  EXPECT_NEAR(volume_of(model, state.x) / volume_of(model, model.rest), share * share * share, 1e-4);
  const Vec3 extent = bounds_of(state.x).extent();
  for (int k3 = 0; k3 < 3; ++k3) EXPECT_NEAR(extent[k3], 0.2 * share, 1e-4 * 0.2);
}

// Two opposite caps of a ball are held and pushed together. The gas' pressure is measured by the balance of forces on
// one half: it must be p0 V0 / V.
TEST(Gas, KeepsPressureTimesVolumeWhereTheAmountIsFixed) {
  BodyDescription body = sphere(3000);
  Handle caps[2] = {{"lower", {}, 0}, {"upper", {}, 0}};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    const double y = body.mesh.rest(v, 1);
    if (std::abs(y) > 0.12) caps[y > 0].vertices.push_back(v);
  }
  body.handles = {caps[0], caps[1]};
  const Model model = build_model(body);
  StepInputs inputs = inputs_of(model, 2000, GasAmount::fixed);
  inputs.solver.iterations = 30;
  State state = rest_state(model);
  OpenWorkspace w;
  for (int i = 0; i < 120; ++i) {
    const double moved = 0.04 * std::min(1.0, i / 60.0);
    for (std::size_t k = 0; k < model.handled.size(); ++k)
      inputs.targets(Eigen::Index(k), 1) =
          model.rest(model.handled[k].vertex, 1) * (1 - moved / std::abs(model.rest(model.handled[k].vertex, 1)));
    ASSERT_FALSE(step(model, inputs, state, w).failed);
  }
  const double rest = volume_of(model, model.rest), volume = volume_of(model, state.x);
  EXPECT_GT(std::abs(volume / rest - 1), 1e-4);
  // At rest the springs' forces on the free vertices, found from the elements alone, balance the gas'.
  StepInputs without = inputs;
  without.air.clear();
  begin_step(model, without, state, w);
  w.y = state.x;
  w.current.x = state.x;
  evaluate(model, w, w.current, Wanted::gradient);
  const Positions unit = forces_at(model, inputs_of(model, 1, GasAmount::open), state.x);  // for a pressure of 1 Pa
  const double gauge = w.current.gradient.cwiseProduct(unit).sum() / unit.squaredNorm();
  EXPECT_NEAR((gauge + atmospheric_pressure) * volume / ((2000 + atmospheric_pressure) * rest), 1, 0.01);
  const double law = (2000 + atmospheric_pressure) * rest / volume - atmospheric_pressure;
  EXPECT_NEAR(gauge / law, 1, 0.02);
}

// Newton's method and the quasi-Newton method find one minimum of a step in which a balloon is filled at once.
TEST(Gas, LeadsAllSolversToOneMinimum) {
  const Model model = build_model(sphere());
  for (const GasAmount amount : {GasAmount::open, GasAmount::fixed}) {
    StepInputs inputs = inputs_of(model, 1500, amount);
    inputs.solver.iterations = 10;
    const State before = rest_state(model);
    State usual = before, newton = before;
    OpenWorkspace w;
    const StepReport report = step(model, inputs, usual, w);
    ASSERT_FALSE(report.failed);
    EXPECT_LT(report.line_search, 25);
    const Reference::StepErrors errors = Reference(model).step_errors(model, inputs, before, usual, w);
    EXPECT_LT(errors.error.value_or(0), 1e-3) << int(amount);
    inputs.solver.iterations = 100;
    usual = before;
    step(model, inputs, usual, w);
    const auto rule = make_rule(Method::newton, model);
    inputs.solver = settings_of(Method::newton, inputs.solver);
    inputs.solver.iterations = 60;
    step(model, inputs, newton, w, *rule);
    EXPECT_LT(w.current.gradient.norm(), 1e-6 * (model.mass[0] / (model.time_step * model.time_step)));
    EXPECT_LT((newton.x - usual.x).norm(), 1e-4 * (newton.x - before.x).norm());
  }
}

// Springs, gas and motion of a balloon that is filled at once exchange their energies. Backward Euler takes some, and
// nothing may come from nothing.
TEST(Gas, ClosesTheBalanceOfEnergy) {
  for (const GasAmount amount : {GasAmount::open, GasAmount::fixed}) {
    const Model model = build_model(sphere());
    StepInputs inputs = inputs_of(model, 0, amount);
    State state = rest_state(model);
    OpenWorkspace w;
    w.prepare(model, inputs.solver);
    EnergyBudget budget;
    budget.start(model, inputs, state, w);
    double least = 0;
    for (int i = 0; i < 150; ++i) {
      inputs.air.front().gas->gauge = 20.0 * std::min(i, 75);
      budget.before_step(model, inputs, state, w);
      const Positions q = state.x;
      ASSERT_FALSE(step(model, inputs, state, w).failed);
      budget.after_step(model, inputs, q, state, w);
      least = std::min(least, budget.energies().gas);
      EXPECT_LE(budget.balance().from_nothing, 1e-3 * budget.balance().exchanged()) << i;
    }
    EXPECT_LT(least, -0.1);  // the gas has done work
    EXPECT_NEAR(budget.energies().total(), budget.balance().put_in, 0.1 * budget.balance().exchanged());
  }
}

TEST(Gas, NeedsASurfaceThatIsClosedAndTurnedOneWay) {
  const TriMesh box = test::box_surface({0.1, 0.2, 0.3});
  EXPECT_EQ(why_not_closed(box.triangles, box.points), "");
  EXPECT_EQ(why_not_closed(test::inside_out(box).triangles, box.points), "");
  EXPECT_EQ(why_not_closed(test::without_triangle(box, 3).triangles, box.points),
            "is not closed: 3 of its edges belong to an odd number of triangles");
  TriMesh turned = box;
  std::swap(turned.triangles(0, 0), turned.triangles(0, 1));
  EXPECT_EQ(why_not_closed(turned.triangles, turned.points),
            "has triangles that are turned against their neighbours, at 3 edges: it has no inside");
  TriMesh flat = box;
  flat.points.col(1).setZero();
  EXPECT_EQ(why_not_closed(flat.triangles, flat.points), "encloses no volume at rest");
  EXPECT_EQ(why_not_closed(Triangles(0, 3), box.points), "has no triangles");
}

}  // namespace gas_test
}  // namespace supple
