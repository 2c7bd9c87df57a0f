// Tests bodies at rest under their own weight against closed-form answers: a hanging bar that stretches far, and a
// cantilever under refinement.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>

#include "geometry/tetrahedra/tetrahedralize.h"
#include "geometry/triangles/surface_thickness.h"
#include "support/bodies.h"

namespace supple {
namespace statics_test {

constexpr double gravity = 9.81;

BodyDescription held_box(const Vec3& extent, const Eigen::Vector3i& cells, const Material& material, int held_axis) {
  BodyDescription body;
  body.name = "box";
  body.mesh = box_mesh(extent, cells);
  body.materials = {material};
  body.precision = Precision::double_precision;
  body.time_step = 100;  // so long that inertia hardly resists
  Handle end{"end", {}, 0};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, held_axis) < 1e-9) end.vertices.push_back(v);
  }
  body.handles.push_back(end);
  return body;
}

// Makes steps without velocity until nothing moves; then the forces are in balance.
Positions equilibrium(const BodyDescription& body, const Vec3& pull) {
  const Model model = build_model(body);
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity = pull;
  inputs.solver.iterations = 3000;
  inputs.solver.history = 30;
  State state = rest_state(model);
  Threads threads(2);
  OpenWorkspace w;
  w.threads = &threads;
  for (int step_number = 0; step_number < 10; ++step_number) {
    const Positions before = state.x;
    step(model, inputs, state, w);
    state.v.setZero();
    if ((state.x - before).cwiseAbs().maxCoeff() < 1e-9 * model.size) break;
  }
  return in_input_order(model, state.x) - body.mesh.rest;
}

// Returns the mean displacement of the end face.
double end_displacement(const BodyDescription& body, const Positions& moved, int long_axis, int axis) {
  const double end = body.mesh.rest.col(long_axis).maxCoeff();
  double sum = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, long_axis) < end - 1e-9) continue;
    sum += moved(v, axis);
    ++count;
  }
  return sum / count;
}

TEST(Statics, AHangingBarStretchesAsTheOneDimensionalSolutionSays) {
  // Without lambda, nothing couples the sides to the length, and each section carries the weight below it: f(s(X)) =
  // rho g (L - X). Here f is mu (s - 1/s) for Neo-Hookean and 4 mu (s-1)^3 for the polynomial.
  const double length = 1, density = 1000, mu = 1.2e4;
  const double w = density * gravity * length / mu;  // 0.82: the top is stretched by half
  // The extension is the integral of s - 1 with s = (u + sqrt(u^2 + 4))/2 over u from 0 to w, times L/w.
  const double root = std::sqrt(w * w + 4);
  const double neo_hookean = length * ((w * w / 4 + (w * root / 2 + 2 * std::asinh(w / 2)) / 2) / w - 1);
  const double polynomial = length * 0.75 * std::cbrt(w / 4);
  for (const auto& [material, expected, tolerance] :
       {std::tuple<Material, double, double>{NeoHookean{mu, 0}, neo_hookean, 2e-4},
        {Polynomial{mu}, polynomial, 2e-3}}) {
    double last = 1;
    for (const int cells : {4, 16, 64}) {
      const BodyDescription body = held_box(Vec3(length, 0.1, 0.1), {cells, 1, 1}, material, 0);
      const double found = end_displacement(body, equilibrium(body, Vec3(gravity, 0, 0)), 0, 0);
      const double error = std::abs(found / expected - 1);
      std::cout << name_of(material) << ", " << cells << " cells: " << found << " of " << expected << ", error "
                << error << '\n';
      EXPECT_LT(error, last) << name_of(material);
      last = error;
    }
    EXPECT_LT(last, tolerance) << name_of(material);
  }
}

TEST(Statics, ACantileverConvergesToTimoshenkosBeam) {
  const double length = 1, thick = 0.125, density = 1000;
  const double young = 4e9;  // so stiff that it sinks by less than a thousandth of its length and stays linear
  const auto tip = [&](int cells, double poisson) {
    const BodyDescription body = held_box(Vec3(length, thick, thick), {8 * cells, cells, cells},
                                          Corotated::from(Lame::from_young(young, poisson)), 0);
    return -end_displacement(body, equilibrium(body, Vec3(0, -gravity, 0)), 0, 1);
  };
  // The deflection follows Timoshenko 1921, with the shear coefficient of a square section without Poisson's effect,
  // 5/6 (Cowper 1966).
  const double load = density * gravity * thick * thick, inertia = std::pow(thick, 4) / 12;
  const double shear = young / 2;
  const double expected = load * std::pow(length, 4) / (8 * young * inertia) +
                          load * length * length / (2 * 5.0 / 6 * shear * thick * thick);
  const double u4 = tip(4, 0), u8 = tip(8, 0), u16 = tip(16, 0);
  const double order = std::log2((u8 - u4) / (u16 - u8));
  const double limit = u16 + (u16 - u8) / (std::pow(2, order) - 1);  // Richardson's extrapolation
  std::cout << "tip " << u4 << ' ' << u8 << ' ' << u16 << " order " << order << " limit " << limit << " of " << expected
            << '\n';
  EXPECT_GE(order, 1.7);
  EXPECT_NEAR(limit / expected, 1, 0.02);
  // Nearly incompressible linear tetrahedra lock; the test reports that and does not hide it.
  const double locked2 = tip(2, 0.49), locked4 = tip(4, 0.49);
  std::cout << "at Poisson's ratio 0.49: " << locked2 / expected << ' ' << locked4 / expected << " of the beam's\n";
  EXPECT_LT(locked4, u4);
}

}  // namespace statics_test
}  // namespace supple
