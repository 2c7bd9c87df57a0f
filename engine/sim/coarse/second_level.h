// Corrects search directions on the second level. The first level starts them from the paper's A^-1. On the motions Z
// of the body's clusters (coarse_system.h), the second has the elastic Hessian H in place of A's resistance to turning:
//
//   B^-1 = A^-1 + Z D Z^T,   D = (Z^T (M/h^2 + H) Z)^-1 - (Z^T A Z)^-1
//
// which is a two-level additive Schwarz method without what the first level has on Z already (Smith, Bjorstad, Gropp
// 1996, "Domain decomposition", section 1.2, has such preconditioners). B is symmetric, and positive definite. Contacts
// are added to B as they are to A (contact/contact_direction.h).
#pragma once

#include <Eigen/Cholesky>

#include "sim/coarse/coarse_system.h"

namespace supple {

class SecondLevel {
 public:
  void prepare(const Model& model) { system_.make(model); }
  const CoarseSystem& system() const { return system_; }

  // Computes D for a search that starts at x. Returns false where there is no D, because the body has no tetrahedra or
  // is far from its rest shape.
  bool begin(const Model& model, const Positions& x);

  // Moves Z, but not D, to the positions of another iterate: parts turn about the places where they are now. With Z
  // left where the search began, stiff cubes that were thrown with spin turned 20 to 300 % wrong in an impact.
  void move_to(const Positions& x) {
    ++pose_;
    x_ = x;
  }

  int columns() const { return system_.columns(); }
  std::uint64_t pose() const { return pose_; }                       // counts the calls of begin
  const Eigen::MatrixXd& difference() const { return difference_; }  // D, r x r

  // These use Z at the positions of the last begin or move_to.
  // Computes Z^T f for forces (n_free x 3).
  void restrict(const Model& model, const Positions& forces, Threads* threads, Eigen::VectorXd& result) {
    system_.restrict(model, x_, forces, Vec3::Zero(), threads, result);
  }
  // Adds Z^T of a force on one free vertex to r numbers.
  void restrict_one(std::int32_t vertex, const Vec3& force, double* sums) const {
    system_.restrict_one(vertex, force, x_, sums);
  }
  // Adds Z D f to motions (n_free x 3).
  void add(const Model& model, const Eigen::VectorXd& f, Threads* threads, Positions& motions);

  // Adds P Z D Z^T P^T f for forces f. Where nothing holds the body, P takes out the motion of its centre of mass,
  // which the first level has exactly.
  void add_to(const Model& model, const Positions& forces, Threads* threads, Positions& motions);

 private:
  CoarseSystem system_;
  std::uint64_t pose_ = 0;
  Positions x_;  // n x 3 [m]
  Eigen::MatrixXd difference_;
  Eigen::VectorXd motion_, restricted_;
  Eigen::MatrixXd matrix_, inverse_;  // scratch
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace supple
