// Corrects search directions on the second level. The first level starts them from the paper's A^-1. On the motions Z
// of the bodies' clusters (coarse_system.h), the second has the elastic Hessian H in place of A's resistance to
// turning:
//
//   B^-1 = A^-1 + Z D Z^T,   D = (Z^T (M/h^2 + H) Z)^-1 - (Z^T A Z)^-1
//
// which is a two-level additive Schwarz method without what the first level has on Z already (Smith, Bjorstad, Gropp
// 1996, "Domain decomposition", section 1.2, has such preconditioners). B is symmetric, and positive definite. Contacts
// are added to B as they are to A (contact/contact_direction.h). D has a block for each part of the model, and zeros
// elsewhere.
#pragma once

#include <Eigen/Cholesky>

#include "sim/coarse/coarse_system.h"

namespace supple {

class SecondLevel {
 public:
  void prepare(const Model& model) { system_.make(model); }
  const CoarseSystem& system() const { return system_; }

  // Computes D for a search that starts at x. The block is 0 for a solid that A does not keep from turning and for a
  // part that is far from its rest shape, and empty for a part without clusters. Returns false where all blocks
  // are 0 or empty.
  bool begin(const Model& model, const Positions& x);

  // Moves Z, but not D, to the positions of another iterate: parts turn about the places where they are now. With Z
  // left where the search began, stiff cubes that were thrown with spin turned 20 to 300 % wrong in an impact.
  void move_to(const Positions& x) {
    ++pose_;
    x_ = x;
  }

  int columns() const { return system_.columns(); }
  std::uint64_t pose() const { return pose_; }  // counts the calls of begin and move_to
  // Returns the block of D with the columns of one part.
  const Eigen::MatrixXd& difference(int part) const { return difference_[part]; }
  // Returns D times a matrix or a vector of r rows.
  template <class Numbers>
  Numbers difference_times(const Numbers& numbers) const {
    Numbers product;
    multiply(numbers, product);
    return product;
  }

  // These use Z at the positions of the last begin or move_to.
  // Computes Z^T f for forces (n_free x 3).
  void restrict(const Model& model, const Positions& forces, Threads* threads, Eigen::VectorXd& result) {
    accelerations_.assign(model.parts.size(), Vec3::Zero());
    system_.restrict(model, x_, forces, accelerations_, threads, result);
  }
  // Adds Z^T of a force on one free vertex to r numbers.
  void restrict_one(std::int32_t vertex, const Vec3& force, double* sums) const {
    system_.restrict_one(vertex, force, x_, sums);
  }
  // Adds Z D f to motions (n_free x 3).
  void add(const Model& model, const Eigen::VectorXd& f, Threads* threads, Positions& motions);

  // Adds P Z D Z^T P^T f for forces f. Where nothing holds a body, P takes out the motion of its centre of mass, which
  // the first level has exactly.
  void add_to(const Model& model, const Positions& forces, Threads* threads, Positions& motions);

 private:
  bool find_difference(int part);
  template <class Numbers>
  void multiply(const Numbers& numbers, Numbers& product) const;
  bool moves_freely(const Model& model, int part) const {
    return model.parts[part].floats && system_.columns_of(part) > 0;
  }

  CoarseSystem system_;
  std::uint64_t pose_ = 0;
  Positions x_;                              // n x 3 [m]
  std::vector<Eigen::MatrixXd> difference_;  // by part
  std::vector<Vec3> accelerations_;          // by part [m/s^2]
  Eigen::VectorXd motion_, restricted_;
  Eigen::MatrixXd matrix_, inverse_;  // scratch
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

template <class Numbers>
void SecondLevel::multiply(const Numbers& numbers, Numbers& product) const {
  if (difference_.size() == 1) {
    product.noalias() = difference_[0] * numbers;
    return;
  }
  product.resize(numbers.rows(), numbers.cols());
  for (int part = 0; part < system_.parts(); ++part) {
    const int first = system_.first_column(part), count = system_.columns_of(part);
    if (count > 0) product.middleRows(first, count).noalias() = difference_[part] * numbers.middleRows(first, count);
  }
}

}  // namespace supple
