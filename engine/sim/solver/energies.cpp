#include "sim/solver/energies.h"

namespace supple {

Energies energies(const Model& model, const State& state, const Vec3& gravity, Workspace& w) {
  Energies result;
  for (int v = 0; v < model.free; ++v) {
    result.kinetic += 0.5 * model.mass[v] * state.v.row(v).squaredNorm();
    result.gravitational -= model.mass[v] * (state.x.row(v) - model.rest.row(v)).dot(gravity);
  }
  result.elastic = elastic_energy(model, w, state.x);
  return result;
}

}  // namespace supple
