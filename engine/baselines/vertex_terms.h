// Computes what a vertex alone adds to g: its inertia, the spring of a soft handle, seams, its row of the damping, and
// air. Methods that treat elements one by one add the elements' forces themselves. The whole of g is in
// sim/solver/objective.h.
#pragma once

#include "sim/model/bending.h"
#include "sim/solver/open_workspace.h"

namespace supple {

struct VertexTerms {
  Vec3 slope;        // dg/dx_v [N]
  double stiffness;  // the second derivative is this times the identity [N/m]
};

inline VertexTerms vertex_terms(const Model& model, const OpenWorkspace& w, const Positions& x, int v) {
  const double inertia = model.scheme.inertia / (model.time_step * model.time_step) * model.mass[v];
  const double theta = model.scheme.theta;
  VertexTerms terms{inertia * (x.row(v) - w.y.row(v)).transpose(), inertia};
  if (!model.handle_stiffness.empty() && model.handle_stiffness[v] > 0) {
    Vec3 place = x.row(v);
    if (theta < 1) place = theta * place + (1 - theta) * w.start_copy.row(v).transpose();
    // The scheme's energy times theta is 1 for both integrators.
    terms.slope += model.handle_stiffness[v] * (place - w.target.row(v).transpose());
    terms.stiffness += theta * model.handle_stiffness[v];
  }
  if (!model.bending.begin.empty()) {
    // Both integrators evaluate forces at theta x + (1 - theta) q.
    const Model::SparseRows& rows = model.bending;
    for (std::int32_t k = rows.begin[v]; k < rows.begin[v + 1]; ++k) {
      Vec3 apart = theta * (x.row(rows.column[k]) - x.row(v)).transpose();
      if (theta < 1) apart += (1 - theta) * (w.start_copy.row(rows.column[k]) - w.start_copy.row(v)).transpose();
      terms.slope += rows.value[k] * apart;
    }
    terms.stiffness += theta * bending_diagonal(rows, v);
  }
  for (const auto& [number, factor] : model.seams.of(std::size_t(v))) {
    const SeamPair& pair = model.seams.pairs[number];
    Vec3 apart = theta * pair.apart(x.data()) - w.seam_gaps.row(number).transpose();
    if (theta < 1) apart += (1 - theta) * pair.apart(w.start_copy.data());
    terms.slope += pair.stiffness * factor * apart;
    terms.stiffness += theta * pair.stiffness * factor * factor;
  }
  if (!model.damping.begin.empty()) {
    for (std::int32_t k = model.damping.begin[v]; k < model.damping.begin[v + 1]; ++k) {
      const std::int32_t other = model.damping.column[k];
      terms.slope += model.damping.value[k] * (x.row(other) - w.start_copy.row(other)).transpose();
      if (other == v) terms.stiffness += model.damping.value[k];
    }
  }
  if (w.air.act()) {
    const AirForces::VertexShare air = w.air.share_of(model, x, v);
    terms.slope += air.slope;
    terms.stiffness += air.stiffness;
  }
  return terms;
}

}  // namespace supple
