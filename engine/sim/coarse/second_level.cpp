#include "sim/coarse/second_level.h"

namespace supple {

bool SecondLevel::begin(const Model& model, const Positions& x) {
  ++pose_;
  system_.make(model);
  if (columns() == 0 || !system_.turn_to(x)) return false;
  x_ = x;
  difference_.resize(system_.parts());
  bool any = false;
  for (int part = 0; part < system_.parts(); ++part) {
    const bool found = system_.has_matrices(part) && find_difference(part);
    if (!found) difference_[part].setZero(system_.columns_of(part), system_.columns_of(part));
    any |= found;
  }
  return any;
}

// A motion that hardly moves any free vertex has next to no inertia. So that both matrices can be inverted, the same
// small stiffness is added to both; it cancels in D.
bool SecondLevel::find_difference(int part) {
  const int count = system_.columns_of(part);
  const Eigen::MatrixXd &constant = system_.constant(part), &hessian = system_.hessian(part);
  Eigen::MatrixXd& difference = difference_[part];
  inverse_.resize(count, count);
  difference.setZero(count, count);
  for (const auto& [matrix, sign] : {std::pair(&hessian, 1.0), std::pair(&constant, -1.0)}) {
    matrix_ = *matrix;
    matrix_.diagonal() += 1e-9 * constant.diagonal();
    factor_.compute(matrix_);
    if (factor_.info() != Eigen::Success) return false;
    inverse_.setIdentity();
    factor_.solveInPlace(inverse_);
    difference += sign * inverse_;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < i; ++j)
      difference(i, j) = difference(j, i) = 0.5 * (difference(i, j) + difference(j, i));
  }
  return true;
}

void SecondLevel::add(const Model& model, const Eigen::VectorXd& f, Threads* threads, Positions& motions) {
  multiply(f, motion_);
  system_.prolong(model, x_, motion_, threads, motions);
}

void SecondLevel::add_to(const Model& model, const Positions& forces, Threads* threads, Positions& motions) {
  accelerations_.assign(model.parts.size(), Vec3::Zero());
  for (int p = 0; p < system_.parts(); ++p) {
    if (!moves_freely(model, p)) continue;
    const Part& part = model.parts[p];
    Vec3& mean = accelerations_[p];
    for (int v = part.first_free; v < part.first_free + part.free; ++v) mean += forces.row(v).transpose();
    mean /= part.mass;
  }
  system_.restrict(model, x_, forces, accelerations_, threads, restricted_);
  multiply(restricted_, motion_);
  const std::vector<Vec3>& moved = system_.prolong(model, x_, motion_, threads, motions);
  for (int p = 0; p < system_.parts(); ++p) {
    if (!moves_freely(model, p)) continue;
    const Part& part = model.parts[p];
    const Eigen::RowVector3d back = -moved[p].transpose() / part.mass;
    for (int v = part.first_free; v < part.first_free + part.free; ++v) motions.row(v) += back;
  }
}

}  // namespace supple
