#include "sim/solver/hessian_matrix.h"

#include "base/error.h"

namespace supple {

Mat3 stiffness_of(const Contact& contact, const Positions& x) {
  const Mat3 along = contact.normal * contact.normal.transpose();
  Mat3 stiffness = Mat3::Zero();
  if (gap(contact, x) < 0) stiffness += 2 * contact.stiffness * along;
  if (contact.friction > 0) stiffness += friction_stiffness(contact, x) * (Mat3::Identity() - along);
  return stiffness;
}

void HessianMatrix::assemble(const Model& model, const ElementMatrices& elements, const std::vector<Contact>& contacts,
                             const Positions& x) {
  ElasticHessian::assemble(model, elements);
  for (const Contact& contact : contacts) add_stiffness(contact.stencil, stiffness_of(contact, x));
}

void HessianMatrix::add_stiffness(const ContactStencil& stencil, const Mat3& stiffness) {
  for (int i = 0; i < stencil.free; ++i) {
    for (int j = 0; j <= i; ++j)
      add(stencil.vertex[i], stencil.vertex[j], stencil.weight[i] * stencil.weight[j] * stiffness);
  }
}

void HessianMatrix::assemble(const Model& model, OpenWorkspace& workspace, bool project) {
  const Positions& x = workspace.current.x;
  const double theta = model.scheme.theta;
  if (theta < 1) workspace.middle = theta * x + (1 - theta) * workspace.start_copy;
  element_matrices(model, workspace.threads, theta < 1 ? workspace.middle : x, project, scratch_);
  assemble(model, scratch_, workspace.current.contacts, x);
  if (workspace.air.act()) workspace.air.add_stiffness(model, x, project, *this);
}

bool try_factorize_projected(HessianMatrix& hessian, ChangingFactor& factor) {
  double shift = 1e-10 * hessian.matrix().diagonal().mean();
  for (int tries = 0; !factor.factorize(hessian.matrix()); ++tries) {
    if (tries == 12) return false;
    hessian.shift(shift);
    shift *= 100;
  }
  return true;
}

void factorize_projected(HessianMatrix& hessian, ChangingFactor& factor) {
  if (!try_factorize_projected(hessian, factor))
    throw RunError("a projected Hessian has no Cholesky factor: its numbers are not finite");
}

}  // namespace supple
