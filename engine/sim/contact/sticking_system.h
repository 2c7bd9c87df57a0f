// Solves with A + sum k w w^T over the contacts that stick, w their weights. Where friction is about as stiff as the
// normal, a contact is a spring that is as stiff in all directions, and fits into a matrix that is the same for x, y
// and z. It is factored once in a step, for cloth in layers and cloth that lies: there are more contacts than the small
// system of capacitance.h may have, and most of them stick. Directions stay symmetric and positive definite.
#pragma once

#include <vector>

#include "sim/contact/contact.h"
#include "sim/linear/cholesky.h"
#include "sim/model/model.h"

namespace supple {

class StickingSystem {
 public:
  // Describes a contact that sticks: k stands for its stiffness in all directions [N/m].
  struct Spring {
    ContactStencil stencil;
    double stiffness;
    bool operator==(const Spring& other) const = default;
  };

  // Nothing serves until the next make().
  void clear() { serves_ = false; }
  bool serves() const { return serves_; }

  // Factors the matrix for these springs; the same matrix as before, where nothing has moved, keeps its factor. system:
  // A. x: positions, whose places give the order of elimination. Nothing serves where the matrix has no factor.
  void make(const System& system, const std::vector<Spring>& springs, const Positions& x);

  // Computes the solution z for the forces r, both n_free x 3 [m], [N]. Parts that nothing holds move as a whole
  // exactly as the forces and springs of the last make() say.
  void solve(const Model& model, const Positions& r, Positions& z);

  // Returns an entry of the diagonal [N/m].
  double diagonal(std::int32_t vertex) const { return diagonal_[vertex]; }

 private:
  // Returns whether the matrix has a factor.
  bool factorize(const System& system);

  bool serves_ = false;
  // What the factor was made of, and whether there is one.
  std::uint64_t system_ = 0;  // System::id
  Positions at_;
  std::vector<Spring> springs_;
  bool is_factored_ = false;
  std::vector<double> diagonal_;     // by vertex [N/m]
  std::vector<std::int32_t> order_;  // by place in the order of elimination
  std::vector<std::int32_t> place_;  // by vertex
  Eigen::SparseMatrix<double> sum_, ordered_;
  CholeskyFactor factor_;
  AlignedVector<double> scratch_;
  Positions right_, solution_, forces_;  // n_free x 3; the first two in the order of elimination
};

}  // namespace supple
