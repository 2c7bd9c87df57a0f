#include "baselines/system_matrix.h"

#include <algorithm>

#include "sim/model/bending.h"
#include "sim/model/element_view.h"

namespace supple {

SparseMatrix system_matrix_of(const Model& model) {
  const double scale = model.scheme.energy * model.scheme.theta * model.scheme.theta;
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < model.free; ++v) {
    double own = model.scheme.inertia * model.mass[v] / (model.time_step * model.time_step);
    if (!model.handle_stiffness.empty()) own += scale * model.handle_stiffness[v];
    if (!model.bending.begin.empty()) own += scale * bending_diagonal(model.bending, v);
    entries.emplace_back(v, v, own);
    const auto add_row = [&](const Model::SparseRows& rows, double factor) {
      for (std::int32_t k = rows.begin.empty() ? 0 : rows.begin[v]; !rows.begin.empty() && k < rows.begin[v + 1]; ++k) {
        if (rows.column[k] < model.free) entries.emplace_back(v, rows.column[k], factor * rows.value[k]);
      }
    };
    add_row(model.damping, 1);
    add_row(model.bending, scale);
  }
  for (const SeamPair& pair : model.seams.pairs)
    pair.for_each_entry([&](std::int32_t row, std::int32_t column, double value) {
      if (std::max(row, column) < model.free) entries.emplace_back(row, column, scale * value);
    });
  for_each_element(model, [&](const ElementView& element) {
    const bool solid = element.kind == ElementKind::tetrahedron;
    const auto add = [&](const SystemTerm& term) {
      for (int a = 0; a < corners_of(element.kind); ++a) {
        for (int b = 0; b < corners_of(element.kind); ++b) {
          if (std::max(element.corner[a], element.corner[b]) >= model.free) continue;
          double product = 0;
          for (int i = 0; i < 3; ++i) product += term.row[a][i] * term.row[b][i];
          entries.emplace_back(element.corner[a], element.corner[b], scale * term.weight * product);
        }
      }
    };
    add(model.system_term(element));
    if (solid && !model.fibres.empty() && model.fibres[element.region].kappa > 0)
      add(fibre_term(element, model.fibres[element.region]));
  });
  SparseMatrix matrix(model.free, model.free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace supple
