// Computes one number for each tetrahedron of a body at a pose, from the body's description alone. Pictures show such
// numbers on a surface. No model is needed, so that a film can be coloured from its saved motion. Not here: fields of a
// model for other programs (fields.h).
#pragma once

#include <vector>

#include "base/threads.h"
#include "sim/model/model.h"

namespace supple {

enum class ElementQuantity {
  stretch,       // the largest singular value of F
  compression,   // 1 - the smallest signed singular value: 0 at rest, 1 flat, above 1 inside out
  volume_ratio,  // det F
  energy,        // density over rest volume, fibres included [J/m^3]
  von_mises,     // of Cauchy's stress, fibres included [Pa]
};

class PoseElements {
 public:
  // The body must outlive this object. Its materials may change meanwhile, its mesh may not.
  explicit PoseElements(const BodyDescription& body);

  // Writes the quantity of each element, or NaN where it is not defined: in elements without volume at rest, and for
  // stress where det F = 0. x: the positions of the mesh, n x 3 [m]. threads: null for the calling thread alone.
  void evaluate(ElementQuantity quantity, const Positions& x, Threads* threads, std::vector<double>& values) const;

  // Writes for each vertex the mean over its elements, weighted by their rest volumes. Elements with NaN do not count;
  // a vertex without any other gets NaN.
  void to_vertices(const std::vector<double>& values, Threads* threads, std::vector<double>& by_vertex) const;

 private:
  double of_element(ElementQuantity quantity, const Positions& x, Eigen::Index element) const;

  const BodyDescription& body_;
  std::vector<Mat3> inverse_;   // of the rest edges, by element [1/m]
  std::vector<double> volume_;  // at rest, by element [m^3]
  // The elements of vertex v are elements_[begin_[v] .. begin_[v + 1]).
  std::vector<std::int32_t> begin_, elements_;
};

}  // namespace supple
