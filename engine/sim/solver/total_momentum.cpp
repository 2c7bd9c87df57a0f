#include "sim/solver/total_momentum.h"

#include <algorithm>

namespace supple {
namespace {

// Returns the sum of m x over the free vertices.
Eigen::RowVector3d weighted_sum(const Model& model, const Positions& x) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) sum += model.mass[v] * x.row(v);
  return sum;
}

}  // namespace

bool is_isolated(const Model& model, const OpenWorkspace& w, const std::vector<Contact>& contacts) {
  const auto is_stopped = [](const Contact& contact) {
    return contact.other.is_collider() && (contact.depth > 0 || contact.friction > 0);
  };
  return model.parts.size() > 1 && !w.air.have_drag() && std::ranges::all_of(model.parts, &Part::floats) &&
         std::ranges::none_of(contacts, is_stopped);
}

void keep_center(const Model& model, const Positions& y, Positions& x) {
  const Eigen::RowVector3d shift = (weighted_sum(model, y) - weighted_sum(model, x)) / model.total_mass;
  x.topRows(model.free).rowwise() += shift;
}

double restore_common_translation(const Model& model, OpenWorkspace& w) {
  Eigen::RowVector3d force = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) force -= w.current.gradient.row(v);
  const double h = model.time_step;
  const Eigen::RowVector3d shift =
      (h * h / model.scheme.inertia * force - weighted_sum(model, w.direction)) / model.total_mass;
  w.direction.rowwise() += shift;
  return -force.dot(shift);
}

void take_out_translation(const Model& model, Positions& motion) {
  const Eigen::RowVector3d shift = weighted_sum(model, motion) / model.total_mass;
  motion.topRows(model.free).rowwise() -= shift;
}

}  // namespace supple
