// The rotation of a body at each of its vertices, for what was made of the body in another pose and has to turn with
// it.
#pragma once

#include "base/aligned.h"
#include "base/threads.h"
#include "sim/model/model.h"

namespace supple {

// Rotations by free vertex, in blocks of block_width vertices: nine entries by rows, one vertex in each lane. Vertices
// without tetrahedra have some rotation.
using Rotations = AlignedVector<double>;

class VertexRotations {
 public:
  explicit VertexRotations(const Model& model);

  // Finds the rotations of the polar decompositions of the mean deformation gradients of the tetrahedra around each
  // free vertex, weighted by volume, at x (n x 3 in the model's order). The bits do not depend on threads (may be
  // null).
  void find(const Positions& x, Threads* threads, Rotations& rotations) const;

 private:
  int blocks_ = 0;
  // The mean deformation gradient of vertex v is the sum over k from begin_[v] to begin_[v + 1] of x_j g^T.
  std::vector<std::int32_t> begin_;
  std::vector<std::int32_t> neighbor_;  // j
  std::vector<double> weight_;          // g [1/m], three numbers each
};

// Computes R r or R^T r at each free vertex; both n_free x 3, and may be the same.
void turn(const Rotations& rotations, const Positions& from, Positions& to);
void turn_back(const Rotations& rotations, const Positions& from, Positions& to);

// Replaces each R by R S^T.
void append_inverse(Rotations& rotations, const Rotations& s);

}  // namespace supple
