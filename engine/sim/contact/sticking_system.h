// Solves with A + sum k w w^T over the contacts that stick, w their weights. A contact that sticks is a spring against
// motions in all directions, and fits into a matrix that is the same for x, y and z, where k is the larger of its two
// stiffnesses: across its plane, and along it, that of friction. The matrix is factored once in a step, for cloth in
// layers and cloth that lies: there are more contacts than the small system of capacitance.h may have, and most of them
// stick. It stays symmetric and positive definite.
#pragma once

#include <array>
#include <vector>

#include "sim/contact/contact.h"
#include "sim/linear/cholesky.h"
#include "sim/model/model.h"

namespace supple {

class StickingSystem {
 public:
  // Describes a contact that sticks, with k [N/m].
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

  // Computes the solution z for the forces r, both n_free x 3 [m], [N].
  void solve(const Positions& r, Positions& z);

  // Tells whether the matrix has a spring between the vertices of a contact.
  bool has(const ContactStencil& stencil) const;
  const std::vector<double>& diagonal() const { return diagonal_; }  // by free vertex [N/m]

 private:
  // Returns whether the matrix has a factor.
  bool factorize(const System& system);

  bool serves_ = false;
  // The next four members tell what the factor was made of, and whether there is one.
  std::uint64_t system_ = 0;  // System::id
  Positions at_;
  std::vector<Spring> springs_;
  bool is_factored_ = false;
  std::vector<std::array<std::int32_t, 4>> joined_;  // the vertices of each spring, sorted
  std::vector<double> diagonal_;                     // by vertex [N/m]
  std::vector<std::int32_t> order_;                  // by place in the order of elimination
  std::vector<std::int32_t> place_;                  // by vertex
  Eigen::SparseMatrix<double> sum_, ordered_;
  CholeskyFactor factor_;
  AlignedVector<double> scratch_;
  Positions right_, solution_;  // n_free x 3, in the order of elimination
};

}  // namespace supple
