#include "sim/coarse/second_level.h"

namespace supple {

// A motion that hardly moves any free vertex has next to no inertia. So that both matrices can be inverted, the same
// small stiffness is added to both; it cancels in D.
bool SecondLevel::begin(const Model& model, const Positions& x) {
  ++pose_;
  system_.make(model);
  const int count = columns();
  if (count == 0 || !system_.turn_to(x)) return false;
  x_ = x;
  inverse_.resize(count, count);
  difference_.setZero(count, count);
  for (const auto& [matrix, sign] : {std::pair(&system_.hessian(), 1.0), std::pair(&system_.constant(), -1.0)}) {
    matrix_ = *matrix;
    matrix_.diagonal() += 1e-9 * system_.constant().diagonal();
    factor_.compute(matrix_);
    if (factor_.info() != Eigen::Success) return false;
    inverse_.setIdentity();
    factor_.solveInPlace(inverse_);
    difference_ += sign * inverse_;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < i; ++j)
      difference_(i, j) = difference_(j, i) = 0.5 * (difference_(i, j) + difference_(j, i));
  }
  return true;
}

void SecondLevel::add(const Model& model, const Eigen::VectorXd& f, Threads* threads, Positions& motions) {
  motion_.noalias() = difference_ * f;
  system_.prolong(model, x_, motion_, threads, motions);
}

void SecondLevel::add_to(const Model& model, const Positions& forces, Threads* threads, Positions& motions) {
  const Part& part = model.parts.front();  // the only one (CoarseSystem::make)
  Vec3 mean = Vec3::Zero();
  if (part.floats) {
    for (int v = 0; v < model.free; ++v) mean += forces.row(v).transpose();
    mean /= part.mass;
  }
  system_.restrict(model, x_, forces, mean, threads, restricted_);
  motion_.noalias() = difference_ * restricted_;
  const Vec3 moved = system_.prolong(model, x_, motion_, threads, motions);
  if (!part.floats) return;
  const Eigen::RowVector3d back = -moved.transpose() / part.mass;
  for (int v = 0; v < model.free; ++v) motions.row(v) += back;
}

}  // namespace supple
