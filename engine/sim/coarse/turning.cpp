#include "sim/coarse/turning.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/coarse/cross_matrix.h"

namespace supple {
namespace {

// Returns the matrix of the cross product with the axis of a rotation vector [rad].
Mat3 axis_of(const Vec3& angle) { return cross_matrix(angle / angle.norm()); }

constexpr double least_angle = 1e-8;  // [rad]; a smaller turn stretches by no more than round-off

}  // namespace

// Backward Euler leads a free body that turned by theta in the step before to y = (1 + [sin theta] K - (1 - cos theta)
// K^2) q, with K the cross product with the axis; it turns by the polar decomposition of that.
void Turning::take_velocity(const CoarseSystem& system, const Positions& x, const Positions& motion) {
  system.find_turns(x, motion, turns_);
  by_cluster_.assign(turns_.size(), Mat3::Zero());
  energy_.assign(std::size_t(system.parts()), 0.0);
  for (std::size_t c = 0; c < turns_.size(); ++c) {
    const double sine = std::min(turns_[c].angle.norm(), 1.0);
    if (!(sine > least_angle)) continue;
    const Mat3 k = axis_of(turns_[c].angle), k2 = k * k;
    const double most = 1 - std::sqrt(1 - sine * sine);
    const Vec3& normal = turns_[c].normal;
    const double directions = 2 + normal.dot(k2 * normal);  // across the axis, in which the strain is known
    const double widened = std::clamp(-turns_[c].strain.cwiseProduct(k2).sum() / directions, 0.0, most);
    const double angle = std::atan2(sine, 1 + widened);
    by_cluster_[c] = (std::sin(angle) - turns_[c].angle.norm()) * k + (1 - std::cos(angle) + widened) * k2;
    energy_[system.part_of(c)] += 0.5 * turns_[c].stiffness * by_cluster_[c].squaredNorm();
  }
}

void Turning::take_tangent(const CoarseSystem& system, const Positions& x, const Positions& motion) {
  system.find_turns(x, motion, turns_);
  by_cluster_.assign(turns_.size(), Mat3::Zero());
  energy_.assign(std::size_t(system.parts()), 0.0);
  for (std::size_t c = 0; c < turns_.size(); ++c) {
    const double angle = turns_[c].angle.norm();
    if (!(angle > least_angle)) continue;
    const Mat3 k = axis_of(turns_[c].angle);
    by_cluster_[c] = (std::sin(angle) - angle) * k + (1 - std::cos(angle)) * k * k;
    energy_[system.part_of(c)] += 0.5 * turns_[c].stiffness * by_cluster_[c].squaredNorm();
  }
}

double Turning::energy() const { return std::accumulate(energy_.begin(), energy_.end(), 0.0); }

void Turning::correct(const Model& model, const CoarseSystem& system, const Positions& x, SolveScratch& scratch,
                      Positions& correction) {
  by_vertex_.resize(model.vertices);
  for (int v = 0; v < model.vertices; ++v) by_vertex_[v] = system.mean_at(v, by_cluster_);
  right_.setZero(model.free, 3);
  const auto add = [&](std::int32_t i, std::int32_t j, double entry) {
    const Vec3 edge = -0.5 * entry * (x.row(i) - x.row(j)).transpose();
    const Vec3 part = (by_vertex_[i] + by_vertex_[j]) * edge;
    right_.row(i) += part.transpose();
    if (j < model.free) right_.row(j) -= part.transpose();
  };
  for (int column = 0; column < model.free; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(model.matrix, column); entry; ++entry) {
      if (entry.row() != column) add(static_cast<std::int32_t>(entry.row()), column, entry.value());
    }
  }
  for (const System::Coupling& entry : model.couplings) add(entry.free, entry.held, entry.value);
  correction.resize(model.free, 3);
  solve_system(model, right_, correction, scratch);
}

}  // namespace supple
