#include "baselines/initial_hessians.h"

#include <cmath>
#include <vector>

#include "base/stretches.h"
#include "sim/model/element_view.h"

namespace supple {
namespace {

Eigen::Map<Eigen::VectorXd> vector_of(Positions& p) { return {p.data(), p.size()}; }

// Finds the mean rotation of the elements around each free vertex, weighted by volume.
void vertex_rotations(const Model& model, const Positions& x, std::vector<Mat3>& rotation) {
  rotation.assign(model.free, Mat3::Zero());
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    const Mat3 weighted = element.field[9] * deformation_gradient(x, element);
    for (const std::int32_t v : element.corner) {
      if (v < model.free) rotation[v] += weighted;
    }
  });
  for (Mat3& r : rotation) r = r.isZero(0) ? Mat3(Mat3::Identity()) : nearest_rotation(r);
}

// Replaces r_i by R_i r_i, or by R_i^T r_i.
void turn(const std::vector<Mat3>& rotation, bool back, Positions& r) {
  for (std::size_t v = 0; v < rotation.size(); ++v) {
    const Vec3 row = r.row(static_cast<Eigen::Index>(v));
    r.row(static_cast<Eigen::Index>(v)) =
        (back ? Vec3(rotation[v].transpose() * row) : Vec3(rotation[v] * row)).transpose();
  }
}

HessianMatrix rest_hessian(const Model& model) {
  HessianMatrix hessian(model);
  ElementMatrices elements;
  element_matrices(model, nullptr, model.rest, true, elements);
  hessian.assemble(model, elements, {}, model.rest);
  return hessian;
}

}  // namespace

void IdentityInverse::accepted(const Model& model, const StepInputs&, OpenWorkspace& w) {
  const auto s = w.trial.x.topRows(model.free) - w.current.x.topRows(model.free);
  const auto t = w.trial.gradient - w.current.gradient;
  const double st = s.cwiseProduct(t).sum(), tt = t.squaredNorm();
  if (st > 1e-10 * std::sqrt(s.squaredNorm() * tt)) scale_ = st / tt;
}

void IdentityInverse::apply(const Model& model, const StepInputs&, OpenWorkspace&, Positions& r, Positions& z) {
  if (scale_ > 0) {
    z = scale_ * r;
    return;
  }
  const double h2 = model.time_step * model.time_step / model.scheme.inertia;
  for (int v = 0; v < model.free; ++v) z.row(v) = h2 / model.mass[v] * r.row(v);
}

HessianInverse::HessianInverse(const Model& model, const HessianSource& source) : source_(source), hessian_(model) {
  if (source.elements == HessianSource::Elements::at_rest) hessian_ = rest_hessian(model);
  factor_.analyze(hessian_.matrix());
  if (source.elements == HessianSource::Elements::at_rest) factorize_projected(hessian_, factor_);
  if (source.elements == HessianSource::Elements::turned_rest) {
    element_matrices(model, nullptr, model.rest, true, rest_);
    turned_ = rest_;
  }
  if (source.turning != HessianSource::Turning::none) made_.assign(model.free, Mat3::Identity());
}

void HessianInverse::begin(const Model& model, const StepInputs&, OpenWorkspace& w) {
  const bool turns = source_.turning != HessianSource::Turning::none;
  const bool from_start = source_.turning == HessianSource::Turning::to_start;
  if (turns) vertex_rotations(model, from_start ? *w.start_positions : w.current.x, now_);
  if (source_.searches > 0 && searches_++ % source_.searches == 0) renew(model, w);
  warp_.resize(now_.size());
  for (std::size_t v = 0; v < now_.size(); ++v) warp_[v] = now_[v] * made_[v].transpose();
}

void HessianInverse::renew(const Model& model, OpenWorkspace& w) {
  if (source_.elements == HessianSource::Elements::turned_rest) {
    turn_elements(model, *w.start_positions);
    hessian_.assemble(model, turned_, w.current.contacts, w.current.x);
  } else {
    hessian_.assemble(model, w, true);
  }
  factorize_projected(hessian_, factor_);
  made_ = now_;
}

// Turns the rest pose's stiffness of each tetrahedron by its rotation at x.
void HessianInverse::turn_elements(const Model& model, const Positions& x) {
  const auto index = [](int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; };
  std::size_t chunk = 0;
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron) return;
    while (element.lane >= (model.chunks[chunk].first_block + model.chunks[chunk].blocks) * block_width) ++chunk;
    const std::size_t at =
        rest_.first[chunk] + std::size_t(element.lane - model.chunks[chunk].first_block * block_width) *
                                 stiffness_numbers(ElementKind::tetrahedron);
    const double* from = &rest_.numbers[at];
    double* to = &turned_.numbers[at];
    const Mat3 rotation = nearest_rotation(deformation_gradient(x, element));
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b) {
        Mat3 block;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) block(i, j) = from[index(3 * a + i, 3 * b + j)];
        }
        block = rotation * block * rotation.transpose();
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < (a == b ? i + 1 : 3); ++j) to[index(3 * a + i, 3 * b + j)] = block(i, j);
        }
      }
    }
  });
}

void HessianInverse::apply(const Model&, const StepInputs&, OpenWorkspace&, Positions& r, Positions& z) {
  if (!warp_.empty()) turn(warp_, true, r);
  factor_.solve(r.data(), z.data());
  if (!warp_.empty()) turn(warp_, false, z);
}

FrameCgInverse::FrameCgInverse(const Model& model, Preconditioner preconditioner, int iterations)
    : preconditioner_(preconditioner), iterations_(iterations), hessian_(model) {
  incomplete_.compute(preconditioner == Preconditioner::rest ? rest_hessian(model).matrix() : system_matrix_of(model));
}

void FrameCgInverse::begin(const Model& model, const StepInputs&, OpenWorkspace& w) {
  hessian_.assemble(model, w, true);
}

void FrameCgInverse::apply(const Model& model, const StepInputs&, OpenWorkspace&, Positions& r, Positions& z) {
  right_ = vector_of(r);
  conjugate_gradients(
      right_, solution_, iterations_, 0,
      [&](const Eigen::VectorXd& v, Eigen::VectorXd& result) { hessian_.multiply(v.data(), result.data()); },
      [&](const Eigen::VectorXd& b, Eigen::VectorXd& x) {
        if (preconditioner_ == Preconditioner::rest) {
          x = incomplete_.solve(b);
          return;
        }
        const Eigen::Map<const Positions> from(b.data(), model.free, 3);
        Eigen::Map<Positions> to(x.data(), model.free, 3);
        for (int c = 0; c < 3; ++c) to.col(c) = incomplete_.solve(Eigen::VectorXd(from.col(c)));
      },
      scratch_);
  vector_of(z) = solution_;
}

SystemCgInverse::SystemCgInverse(const Model& model, int iterations)
    : iterations_(iterations), matrix_(system_matrix_of(model)), inverse_diagonal_(3 * model.free) {
  const Eigen::VectorXd diagonal = matrix_.diagonal();
  for (int v = 0; v < model.free; ++v) inverse_diagonal_.segment<3>(3 * v).setConstant(1 / diagonal[v]);
}

void SystemCgInverse::apply(const Model& model, const StepInputs&, OpenWorkspace&, Positions& r, Positions& z) {
  right_ = vector_of(r);
  conjugate_gradients(
      right_, solution_, iterations_, 0,
      [&](const Eigen::VectorXd& v, Eigen::VectorXd& result) {
        Eigen::Map<Positions>(result.data(), model.free, 3).noalias() =
            matrix_ * Eigen::Map<const Positions>(v.data(), model.free, 3);
      },
      [&](const Eigen::VectorXd& b, Eigen::VectorXd& x) { x = inverse_diagonal_.cwiseProduct(b); }, scratch_);
  vector_of(z) = solution_;
}

}  // namespace supple
