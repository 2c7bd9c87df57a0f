#include "scene/building/solver_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "scene/definition/scene_def.h"
#include "sim/materials/material.h"

namespace supple {

double loss_of_spin(const Body& body) {
  const double k = system_stiffness(body.def.substance.material, body.def.solver.fit).k;
  const double size = bounds_of(body.description.mesh.rest).diagonal();
  const double gyration = size * size / 18;  // I / m of a box, as the mean about its three axes [m^2]
  return 2 * body.def.solver.damping * k / (body.description.density * gyration);
}

std::string damping_text(const SceneDef& scene, const Body& body) {
  if (body.def.solver.damping <= 0 || body.def.cloth || !body.def.handles.empty()) return {};
  const double half_life = std::numbers::ln2 / loss_of_spin(body);
  if (half_life > scene.fps.time_of(scene.frames)) return {};
  return fmt::format(
      "body '{}' will hardly roll or turn: its solver.damping takes half of a spin in some {:.1g} s; "
      "solver.calming takes movement within a body alone",
      body.def.name, half_life);
}

namespace {

bool is_given(const Body& body) { return body.def.solver.settings.matrix != StartMatrix::system; }

// Tells whether the matrix can serve the body's steps (sim/solver/matrix_rule.h).
bool serves(const Body& body) {
  const SolverDef& solver = body.def.solver;
  const bool has_form = solver.settings.matrix == StartMatrix::tangent || !body.def.cloth;
  return solver.method == Method::quasi_newton && solver.integrator == Integrator::backward_euler && has_form;
}

}  // namespace

std::string idle_matrix_text(const std::vector<Body>& bodies) {
  const auto first = std::ranges::find_if(bodies, is_given);
  if (first == bodies.end()) return {};
  if (std::ranges::any_of(bodies, [](const Body& body) { return is_given(body) && serves(body); })) return {};
  const bool turned = first->def.solver.settings.matrix == StartMatrix::turned_hessian;
  return fmt::format("solver.matrix = \"{}\" changes nothing here: it serves quasi-newton and backward-euler alone{}",
                     name_of(first->def.solver.settings.matrix), turned ? ", and no cloth" : "");
}

}  // namespace supple
