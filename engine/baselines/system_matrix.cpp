#include "baselines/system_matrix.h"

#include <algorithm>

#include "sim/model/element_view.h"

namespace supple {

SparseMatrix system_matrix_of(const Model& model) {
  const double scale = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < model.free; ++v) {
    double own = model.scheme.inertia * model.mass[v] / (model.time_step * model.time_step);
    if (!model.handle_stiffness.empty()) own += scale * model.handle_stiffness[v];
    entries.emplace_back(v, v, own);
    if (model.damping.begin.empty()) continue;
    for (std::int32_t k = model.damping.begin[v]; k < model.damping.begin[v + 1]; ++k) {
      if (model.damping.column[k] < model.free)
        entries.emplace_back(v, model.damping.column[k], model.damping.value[k]);
    }
  }
  for_each_element(model, [&](const ElementView& element) {
    const bool solid = element.kind == ElementKind::tetrahedron;
    const auto add = [&](const SystemTerm& term, double k) {
      for (int a = 0; a < corners_of(element.kind); ++a) {
        for (int b = 0; b < corners_of(element.kind); ++b) {
          if (std::max(element.corner[a], element.corner[b]) >= model.free) continue;
          double product = 0;
          for (int i = 0; i < 3; ++i) product += term.row[a][i] * term.row[b][i];
          entries.emplace_back(element.corner[a], element.corner[b], scale * k * term.weight * product);
        }
      }
    };
    add(unit_term(element), solid ? model.stiffness[element.region].k : element.field[1]);
    if (solid && !model.fibres.empty() && model.fibres[element.region].kappa > 0)
      add(fibre_term(element, model.fibres[element.region]), 1);
  });
  SparseMatrix matrix(model.free, model.free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace supple
