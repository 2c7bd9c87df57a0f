#include "sim/model/system_solve.h"

namespace supple {

void restore_translation(const Model& model, const Positions& r, Positions& z) {
  const double h = model.time_step;
  for (const Part& part : model.parts) {
    if (!part.floats) continue;
    Eigen::RowVector3d wanted = Eigen::RowVector3d::Zero(), found = Eigen::RowVector3d::Zero();
    for (int v = part.first_free; v < part.first_free + part.free; ++v) {
      wanted += r.row(v);
      found += model.mass[v] * z.row(v);
    }
    const Eigen::RowVector3d shift = (h * h / model.scheme.inertia * wanted - found) / part.mass;
    z.middleRows(part.first_free, part.free).rowwise() += shift;
  }
}

void solve_system(const Model& model, const Positions& r, Positions& z, SolveScratch& scratch) {
  solve_system(model, model, r, z, scratch);
}

void solve_system(const Model& model, const System& system, const Positions& r, Positions& z, SolveScratch& scratch) {
  system.factor.solve(r.data(), z.data(), scratch);
  restore_translation(model, r, z);
}

}  // namespace supple
