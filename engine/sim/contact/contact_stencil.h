// Describes what a contact acts on: a signed sum u of w_i x_i over up to four vertices. Against a collider it is a
// material point of the body's surface: a vertex, or a point of an edge or of a triangle, and the weights add up to 1.
// Against a place of another surface it is the difference between the point and that place, and the weights add up to
// 0: they are (1, -b1, -b2, -b3) for a vertex and a triangle, and (1 - s, s, t - 1, -t) for two edges. Forces act on
// the vertices by the same weights, so that in the second case no momentum comes from nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/types.h"

namespace supple {

struct ContactStencil {
  std::array<std::int32_t, 4> vertex;        // ascending, so that the free ones come first
  std::array<double, 4> weight{1, 0, 0, 0};  // by vertex, not 0 where the vertex counts
  std::int32_t count = 1;                    // the number of vertices, 1 to 4
  std::int32_t free = 1;                     // the number of those that the solver moves

  static ContactStencil at_vertex(std::int32_t v) { return {{v, v, v, v}}; }
  bool is_vertex() const { return count == 1; }
  // Tells whether it is the difference between places inside two edges.
  bool is_between_edges() const { return count == 4 && weight[0] * weight[1] * weight[2] * weight[3] > 0; }
  bool is_between_surfaces() const { return std::abs(weight[0] + weight[1] + weight[2] + weight[3]) < 0.5; }

  // Returns the sum of vectors by vertex: u of positions, or its motion. x must have rows for all vertices.
  Vec3 at(const Positions& x) const { return sum_over(count, x); }
  // Returns the sum of vectors by free vertex; those of held vertices count as zero.
  Vec3 of_free(const Positions& d) const { return sum_over(std::max(free, 1), d); }
  // Adds a vector to those of the free vertices, by the weights.
  template <class Vector>
  void spread(const Vector& vector, Positions& sums) const {
    for (int k = 0; k < free; ++k) sums.row(vertex[k]) += weight[k] * vector.transpose();
  }
  // Returns the mass that a force on u has to move, 1 / sum of w_i^2 / m_i; held vertices do not move [kg].
  double mass(const std::vector<double>& masses) const {
    if (is_vertex()) return masses[vertex[0]];
    double inverse = 0;
    for (int k = 0; k < free; ++k) inverse += weight[k] * weight[k] / masses[vertex[k]];
    return 1 / inverse;
  }
  // Tells whether two stencils are made of the same vertices by the same weights.
  bool operator==(const ContactStencil& other) const {
    return count == other.count && vertex == other.vertex && weight == other.weight;
  }
  // Returns the sum of the squared weights of the free vertices.
  double weights_squared() const {
    double sum = 0;
    for (int k = 0; k < free; ++k) sum += weight[k] * weight[k];
    return sum;
  }

 private:
  // Returns the sum over the first vertices. It reads rows without asking for their bounds: where layers of cloth lie
  // on each other, sums of fifty thousand stencils are made for each trial iterate.
  Vec3 sum_over(int vertices, const Positions& x) const {
    const double* row = x.data() + 3 * std::ptrdiff_t(vertex[0]);
    Vec3 sum(weight[0] * row[0], weight[0] * row[1], weight[0] * row[2]);
    for (int k = 1; k < vertices; ++k) {
      row = x.data() + 3 * std::ptrdiff_t(vertex[k]);
      sum += Vec3(weight[k] * row[0], weight[k] * row[1], weight[k] * row[2]);
    }
    return sum;
  }
};

}  // namespace supple
