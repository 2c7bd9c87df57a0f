// Tests cloth that is curved at rest: closed forms of rolled sheets, derivatives, and what no turn may change.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/meshes/cloth.h"
#include "sim/model/bending.h"
#include "sim/solver/objective.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/deformations.h"
#include "support/objective_checks.h"

namespace supple {
namespace curved_cloth_test {

// Rolls a flat sheet up to a cylinder about an axis with a given direction in the plane.
Positions rolled(const Positions& flat, double radius, double direction) {
  Positions x(flat.rows(), 3);
  const Eigen::Vector2d axis(std::cos(direction), std::sin(direction)), across(-axis.y(), axis.x());
  for (Eigen::Index v = 0; v < flat.rows(); ++v) {
    const Eigen::Vector2d p = flat.row(v).head<2>().transpose();
    const double angle = p.dot(across) / radius;
    const Eigen::Vector2d in_plane = p.dot(axis) * axis + radius * std::sin(angle) * across;
    x.row(v) << in_plane.x(), in_plane.y(), radius * (1 - std::cos(angle));
  }
  return x;
}

// Makes a sheet that is rolled up at rest, and whose triangles have their size in the flat pattern.
BodyDescription rolled_sheet(int cells, double radius, double direction, double bending) {
  BodyDescription body = test::sheet({1, 1}, {cells, cells}, {test::all_membranes().front(), bending});
  body.mesh.rest = rolled(body.mesh.rest, radius, direction);
  body.curved = true;
  return body;
}

Positions in_model_order(const Model& model, const Positions& input) {
  Positions x(input.rows(), 3);
  for (Eigen::Index v = 0; v < x.rows(); ++v) x.row(v) = input.row(model.input_of[std::size_t(v)]);
  return x;
}

TEST(CurvedCloth, HasTheEnergyOfAPlateFromOneRadiusToAnotherOnThreeMeshes) {
  constexpr double at_rest = 0.5, bending = 3e-5;
  for (const double direction : {0.0, 0.3, std::numbers::pi / 4, std::numbers::pi / 2}) {
    for (const int cells : {32, 48, 64}) {
      const Positions flat = cloth_grid({1, 1}, {cells, cells}).surface.points;
      const Model model = build_model(rolled_sheet(cells, at_rest, direction, bending));
      EXPECT_LT(bending_energy(model, model.rest), 1e-24 * bending);  // round-off
      for (const double curvature : {0.0, 1.0, 3.0, -2.0}) {
        const Positions x = curvature == 0 ? flat : rolled(flat, 1 / curvature, direction);
        const double exact = 0.5 * bending * std::pow(curvature - 1 / at_rest, 2);
        EXPECT_NEAR(bending_energy(model, in_model_order(model, x)) / exact, 1, 0.03)
            << cells << " cells, direction " << direction << ", curvature " << curvature;
      }
    }
  }
}

TEST(CurvedCloth, KnowsTheDirectionInWhichItIsRolledUp) {
  constexpr double radius = 0.5, bending = 3e-5;
  const Positions flat = cloth_grid({1, 1}, {40, 40}).surface.points;
  const Model model = build_model(rolled_sheet(40, radius, 0, bending));
  const Positions other = rolled(flat, radius, std::numbers::pi / 2);
  const double exact = 0.5 * bending * 2 / (radius * radius);  // of the plate |S - S_rest|^2 for two crossed curvatures
  EXPECT_NEAR(bending_energy(model, in_model_order(model, other)) / exact, 1, 0.06);
}

TEST(CurvedCloth, HasTheDerivativesOfItsEnergyAlsoWhereItIsFolded) {
  std::mt19937 random(4);
  const Model model = build_model(rolled_sheet(6, 0.4, 0.4, 2e-3));
  for (const double fold : {0.0, 1.0, 3.0, 3.14159, 3.3}) {
    Positions x = model.rest;
    for (Eigen::Index v = 0; v < x.rows(); ++v) {
      const double out = x(v, 0) - 0.5;
      if (out > 0) x.row(v) << 0.5 + std::cos(fold) * out, x(v, 1), x(v, 2) + std::sin(fold) * out;
    }
    x += test::shaken(Positions::Zero(x.rows(), 3), 1e-3, 7);
    const Positions way = test::shaken(Positions::Zero(x.rows(), 3), 1, 8);
    CurvatureRoom room;
    std::vector<double> energy;
    evaluate_curvature(model.curvature, nullptr, x.data(), room, energy);
    double slope = 0, best = 1e300;
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double size = 0;
    for (int v = 0; v < model.vertices; ++v) {
      double own[3];
      curvature_slope(model.curvature, room, v, own);
      const Vec3 f(own[0], own[1], own[2]);
      slope += f.dot(way.row(v).transpose());
      force += f;
      moment += Vec3(x.row(v).transpose()).cross(f);
      size += f.norm();
    }
    for (const double h : {1e-5, 1e-6, 1e-7})
      best = std::min(
          best, std::abs((bending_energy(model, x + h * way) - bending_energy(model, x - h * way)) / (2 * h) - slope));
    EXPECT_LT(best, 1e-6 * std::abs(slope)) << fold;
    EXPECT_LT(force.norm(), 1e-12 * size) << fold;
    EXPECT_LT(moment.norm(), 1e-12 * size) << fold;
  }
}

TEST(CurvedCloth, ObjectiveHasItsGradientAndItsDifferences) {
  BodyDescription body = rolled_sheet(5, 0.6, 0.2, 0.02);
  body.fabric.membrane = test::all_membranes()[2];
  test::expect_derivative_of_objective(body, "free");
  body.handles.push_back({"edge", {0, 6, 12, 18, 24}});
  body.damping = 0.01;
  test::expect_derivative_of_objective(body, "held and damped");
  body.integrator = Integrator::implicit_midpoint;
  test::expect_derivative_of_objective(body, "implicit midpoint");
}

// Lets a sheet go from rest without gravity, and returns where it is after some time, by model's order.
Positions let_go(const Model& model, const Positions& start, int steps, int iterations, double& trials) {
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity.setZero();
  inputs.solver.iterations = iterations;
  inputs.solver.elements = Precision::double_precision;
  State state = rest_state(model);
  state.x = start;
  OpenWorkspace w;
  double tried = 0, made = 0;
  for (int i = 0; i < steps; ++i) {
    const StepReport& report = step(model, inputs, state, w);
    tried += report.line_search;
    made += report.iterations;
    state.v *= 0.9;  // it shall come to rest
  }
  trials = made > 0 ? tried / made : 0;
  return state.x;
}

TEST(CurvedCloth, AHalfCylinderStaysAndOneThatWasOpenedFlatComesBack) {
  constexpr int cells = 16;
  const double radius = 1 / std::numbers::pi;
  BodyDescription body = rolled_sheet(cells, radius, 0, 1e-2);
  body.fabric.membrane = PlaneNeoHookean::from(PlaneLame::from_young(1e6, 0.3, 5e-4), 1);
  const Model model = build_model(body);
  double trials = 0;
  const Positions still = let_go(model, model.rest, 20, 10, trials);
  EXPECT_LT((still - model.rest).cwiseAbs().maxCoeff(), 2e-3);  // chords are shorter than arcs
  const Positions flat = in_model_order(model, cloth_grid({1, 1}, {cells, cells}).surface.points);
  const Positions back = let_go(model, flat, 300, 10, trials);
  EXPECT_LT(trials, 1.1);
  const auto width = [](const Positions& x) {
    const Positions centered = x.rowwise() - x.colwise().mean();
    return std::sqrt((centered.transpose() * centered).trace() / double(x.rows()));
  };
  EXPECT_NEAR(width(back) / width(model.rest), 1, 0.02);
}

TEST(CurvedCloth, ATurnedCopyMovesInTheSameWay) {
  std::mt19937 random(3);
  const Mat3 turn = test::random_rotation(random);
  BodyDescription body = rolled_sheet(8, 0.5, 0.3, 1e-2);
  const Model model = build_model(body);
  const Positions flat = cloth_grid({1, 1}, {8, 8}).surface.points;
  double trials = 0;
  const Positions there = let_go(model, in_model_order(model, flat), 10, 20, trials);
  body.mesh.rest = body.mesh.rest * turn.transpose();
  const Model turned = build_model(body);
  const Positions elsewhere = let_go(turned, in_model_order(turned, flat * turn.transpose()), 10, 20, trials);
  EXPECT_LT((elsewhere - there * turn.transpose()).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace curved_cloth_test
}  // namespace supple
