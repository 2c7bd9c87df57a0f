// Assembles the Hessian of g with its contacts over the free vertices, 3n x 3n, which Newton's method and several
// initial Hessians use.
#pragma once

#include "sim/contact/contact.h"
#include "sim/linear/changing_factor.h"
#include "sim/model/elastic_hessian.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Returns the stiffness of a contact in force at x, where friction has the stiffness of its secant [N/m].
Mat3 stiffness_of(const Contact& contact, const Positions& x);

class HessianMatrix : public ElasticHessian {
 public:
  using ElasticHessian::ElasticHessian;

  // Sums up what ElasticHessian does, and stiffness_of() the contacts.
  void assemble(const Model& model, const ElementMatrices& elements, const std::vector<Contact>& contacts,
                const Positions& x);

  // Assembles d^2 g at workspace.current with the contacts found there; with `project` each element's Hessian is
  // projected first.
  void assemble(const Model& model, OpenWorkspace& workspace, bool project);

  // Adds a stiffness against motions of the point, or of the difference of two points, that a stencil describes [N/m].
  void add_stiffness(const ContactStencil& stencil, const Mat3& stiffness);

 private:
  ElementMatrices scratch_;
};

// Factors a sum of projected matrices, which is positive definite up to round-off. Where round-off makes it indefinite,
// a shift of that size corrects it. Returns false when no such shift is enough.
bool try_factorize_projected(HessianMatrix& hessian, ChangingFactor& factor);

// Does the same, but throws RunError where no such shift is enough.
void factorize_projected(HessianMatrix& hessian, ChangingFactor& factor);

}  // namespace supple
