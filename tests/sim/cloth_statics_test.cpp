// Tests cloth at rest against closed forms: a strip that hangs, and a cantilever that bends under its own weight.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "baselines/make_rule.h"
#include "geometry/meshes/cloth.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/deformations.h"

namespace supple {
namespace cloth_statics_test {

// Returns where a body comes to rest, by long steps of Newton's method, whose inertia hardly counts.
Positions rest_under(const Model& model, const Vec3& gravity) {
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity = gravity;
  inputs.solver.iterations = 100;
  inputs.solver.newton = false;
  const auto rule = make_rule(Method::newton, model);
  State state = rest_state(model);
  OpenWorkspace w;
  for (int i = 0; i < 40; ++i) {
    const Positions before = state.x;
    step(model, inputs, state, w, *rule);
    state.v.setZero();
    if ((state.x - before).norm() < 1e-7 * model.size) break;
  }
  return in_input_order(model, state.x);
}

std::vector<std::int32_t> vertices_left_of(const Positions& points, double x) {
  std::vector<std::int32_t> list;
  for (std::int32_t v = 0; v < points.rows(); ++v) {
    if (points(v, 0) < x) list.push_back(v);
  }
  return list;
}

TEST(ClothStatics, AHangingStripIsStretchedByItsWeight) {
  constexpr double length = 1, density = 0.2, gravity = 9.81, young = 5e6, thickness = 4e-4;
  const double stiffness = young * thickness;
  const PlaneLame lame = PlaneLame::from_young(young, 0.3, thickness);
  const std::vector<Membrane> membranes = {PlaneNeoHookean::from(lame, 1), PlaneNeoHookean::from(lame, 0.05),
                                           PlaneStVenantKirchhoff::from(lame, 1),
                                           Woven{stiffness, stiffness, 20, 0.05, 2}};
  for (const Membrane& membrane : membranes) {
    BodyDescription strip = test::sheet({length, 0.1}, {40, 4}, {membrane, 0}, density);
    strip.handles = {{"top", vertices_left_of(strip.mesh.rest, 1e-6)}};
    strip.time_step = 1;
    const Model model = build_model(strip);
    const Positions hung = rest_under(model, {gravity, 0, 0});
    const double elongation = hung.col(0).maxCoeff() - length;
    const double exact = density * gravity * length * length / (2 * stiffness);
    EXPECT_NEAR(elongation, exact, 0.01 * exact) << name_of(membrane) << ", compression";
  }
}

// Returns the end (x, -y) of a heavy elastica that is clamped level: B theta'' + w (l - s) cos theta = 0 with theta(0)
// = 0 and theta'(l) = 0 (Bickley 1934, "The heavy elastica"). Its discrete form is convex between level and upright,
// where Newton's method finds it.
Eigen::Vector2d heavy_elastica(double length, double weight_over_stiffness) {
  constexpr int parts = 1000;
  const double h = length / parts;
  Eigen::VectorXd angle = Eigen::VectorXd::Zero(parts);  // in the middle of each part
  for (int iteration = 0; iteration < 200; ++iteration) {
    Eigen::VectorXd diagonal(parts), right(parts);
    for (int i = 0; i < parts; ++i) {
      const double load = h * h * weight_over_stiffness * (length - (i + 0.5) * h);
      // The clamp is half a part before the first middle.
      const double before = i > 0 ? angle[i] - angle[i - 1] : 2 * angle[0];
      const double after = i + 1 < parts ? angle[i + 1] - angle[i] : 0;
      right[i] = after - before + load * std::cos(angle[i]);
      diagonal[i] = (i > 0 ? 1 : 2) + (i + 1 < parts ? 1 : 0) + load * std::sin(angle[i]);
    }
    for (int i = 1; i < parts; ++i) {  // elimination in a matrix with -1 beside the diagonal
      diagonal[i] -= 1 / diagonal[i - 1];
      right[i] += right[i - 1] / diagonal[i - 1];
    }
    for (int i = parts - 1; i >= 0; --i) right[i] = (right[i] + (i + 1 < parts ? right[i + 1] : 0)) / diagonal[i];
    angle = (angle + right).cwiseMax(0).cwiseMin(0.5 * std::numbers::pi);
    if (right.cwiseAbs().maxCoeff() < 1e-12) break;
  }
  return {h * angle.array().cos().sum(), h * angle.array().sin().sum()};
}

TEST(ClothStatics, ACantileverEndsWhereAHeavyElasticaDoesOnGridsAndOnUnevenMeshes) {
  constexpr double length = 0.2, width = 0.05, density = 0.15, gravity = 9.81;
  constexpr int along = 40, across = 8, clamped = 2;  // columns of vertices that are held
  const double cell = length / along;
  for (const double bending : {1e-5, 3e-5, 1e-4, 3e-4, 1e-3}) {
    for (const bool even : {true, false}) {
      TriMesh mesh = cloth_grid({length + cell * clamped, width}, {along + clamped, across}).surface;
      std::mt19937 random(7);
      for (Eigen::Index v = 0; v < mesh.points.rows() && !even; ++v) {
        const double x = mesh.points(v, 0), y = mesh.points(v, 1);
        if (x < cell * (clamped + 0.5) || x > length + cell * (clamped - 0.5) || y < 1e-9 || y > width - 1e-9) continue;
        mesh.points(v, 0) += cell * test::uniform(random, -0.2, 0.2);
        mesh.points(v, 1) += cell * test::uniform(random, -0.2, 0.2);
      }
      BodyDescription strip = test::sheet_of(mesh, {Woven{2e4, 2e4, 5e3, 1, 2}, bending}, density);
      strip.handles = {{"clamp", vertices_left_of(strip.mesh.rest, cell * (clamped + 0.5))}};
      strip.time_step = 1;
      const Model model = build_model(strip);
      const Positions bent = rest_under(model, {0, 0, -gravity});
      Eigen::Vector2d end(0, 0);
      int count = 0;
      for (Eigen::Index v = 0; v < bent.rows(); ++v) {
        if (mesh.points(v, 0) < length + cell * clamped - 1e-9) continue;
        end += Eigen::Vector2d(bent(v, 0) - cell * clamped, -bent(v, 2));
        ++count;
      }
      end /= count;
      // Two columns that are held next to each other are level in the middle between them.
      const Eigen::Vector2d exact =
          heavy_elastica(length + 0.5 * cell, density * gravity / bending) - Eigen::Vector2d(0.5 * cell, 0);
      EXPECT_LT((end - exact).norm(), 0.05 * exact.norm())
          << bending << (even ? " even: " : " uneven: ") << end.transpose() << " for " << exact.transpose();
      // Peirce's bending length, from the angle of the chord (Peirce 1930, "The handle of cloth as a measurable
      // quantity"), is a few hundredths off the elastica itself.
      const double theta = std::atan2(end.y(), end.x());
      if (theta < 0.1 || theta > 0.8) continue;
      const double peirce =
          density * gravity * length * length * length * std::cos(0.5 * theta) / (8 * std::tan(theta));
      EXPECT_NEAR(peirce / bending, 1, 0.08) << bending << ", " << theta;
    }
  }
}

}  // namespace cloth_statics_test
}  // namespace supple
