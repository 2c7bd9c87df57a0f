// Describes a material point of a body's surface where contact is kept: a vertex, or a point of an edge or of a
// triangle between vertices, which moves with the weighted mean of theirs and whose forces act on them by the same
// weights. The weights add up to 1.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"

namespace supple {

struct ContactPoint {
  std::array<std::int32_t, 3> vertex;     // ascending
  std::array<double, 3> weight{1, 0, 0};  // of the vertices, above 0 where they count
  std::int32_t count = 1;                 // vertices: 1 to 3
  std::int32_t free = 1;                  // vertices that the solver moves; they come first

  static ContactPoint at_vertex(std::int32_t v) { return {{v, v, v}}; }
  bool is_vertex() const { return count == 1; }

  // Returns where the point is, or the mean of other vectors by vertex. x must have rows for all vertices of the point.
  Vec3 at(const Positions& x) const {
    Vec3 mean = weight[0] * x.row(vertex[0]);
    for (int k = 1; k < count; ++k) mean += weight[k] * x.row(vertex[k]).transpose();
    return mean;
  }
  // Returns the mean of vectors by free vertex; those of held vertices count as zero.
  Vec3 of_free(const Positions& d) const {
    Vec3 mean = weight[0] * d.row(vertex[0]);
    for (int k = 1; k < free; ++k) mean += weight[k] * d.row(vertex[k]).transpose();
    return mean;
  }
  // Adds a vector to those of the free vertices, by the weights.
  template <class Vector>
  void spread(const Vector& vector, Positions& sums) const {
    for (int k = 0; k < free; ++k) sums.row(vertex[k]) += weight[k] * vector.transpose();
  }
  // Returns the mass that a force at the point has to move, 1 / sum of w_i^2 / m_i; held vertices do not move [kg].
  double mass(const std::vector<double>& masses) const {
    if (is_vertex()) return masses[vertex[0]];
    double inverse = 0;
    for (int k = 0; k < free; ++k) inverse += weight[k] * weight[k] / masses[vertex[k]];
    return 1 / inverse;
  }
  // Tells whether two points are made of the same vertices by the same weights.
  bool operator==(const ContactPoint& other) const {
    return count == other.count && vertex == other.vertex && weight == other.weight;
  }
  // Returns the sum of the squared weights of the free vertices.
  double weights_squared() const {
    double sum = 0;
    for (int k = 0; k < free; ++k) sum += weight[k] * weight[k];
    return sum;
  }
};

}  // namespace supple
