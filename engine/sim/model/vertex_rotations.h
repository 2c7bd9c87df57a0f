// Finds the rotation of a body at each of its vertices, for matrices that were made in another pose and have to turn
// with the body.
#pragma once

#include "base/aligned.h"
#include "base/threads.h"
#include "sim/model/model.h"

namespace supple {

// Holds a matrix for each free vertex: three rows of four numbers, of which the last is 0.
using Rotations = AlignedVector<double>;

class VertexRotations {
 public:
  explicit VertexRotations(const Model& model);

  // Finds the rotations of the polar decompositions of the mean deformation gradients of the tetrahedra around each
  // free vertex, weighted by volume, at x (n x 3 in the model's order); a vertex without tetrahedra has some rotation.
  // The bits do not depend on threads (may be null).
  void find(const Positions& x, Threads* threads, Rotations& rotations) const;

 private:
  int free_ = 0;
  // The mean deformation gradient of vertex v is the sum over k from begin_[v] to begin_[v + 1] of x_j g^T.
  std::vector<std::int32_t> begin_;
  std::vector<std::int32_t> neighbor_;  // j
  AlignedVector<double> weight_;        // g [1/m], four numbers each, of which the last is 0
};

// Computes R^T at each vertex.
void transpose(const Rotations& from, Rotations& to);

// Computes R S at each vertex; `to` may be the same as `r`.
void multiply(const Rotations& r, const Rotations& s, Rotations& to);

// Computes R^T p at each vertex; both n_free x 3, and may be the same.
void turn_back(const Rotations& rotations, const Positions& from, Positions& to);

}  // namespace supple
