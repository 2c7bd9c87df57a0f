// Holds the seams of cloth whose sides lie apart where the film begins, and computes their energy. A pair joins a
// vertex on one side with a place between two vertices on the other: with d = x_a - sum w_i x_i and the gap D that d is
// at the start, E = k/2 |d - s D|^2, where s falls from 1 to 0 while the seam is closed. Its second derivative is
// constant, so it is part of A as a whole, as the matrix of bending is (bending.h), and directions solve it exactly.
// Not here: which places are joined (scene/building/seam_pairs.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/types.h"

namespace supple {

struct Model;
struct Part;

using JoinedVertices = std::pair<std::int32_t, std::int32_t>;

// Joins a vertex with a place between two others.
struct SeamPair {
  std::array<std::int32_t, 3> vertex{};
  std::array<double, 3> factor{};  // of these vertices in d: 1 and minus the weights of the place; their sum is 0
  Vec3 gap = Vec3::Zero();         // D, what d is at the start [m]
  double stiffness = 0;            // k, which the model's values set [N/m]

  Vec3 apart(const double* x) const {  // d at x, n x 3 [m]
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i) sum += factor[i] * Eigen::Map<const Vec3>(x + 3 * std::size_t(vertex[i]));
    return sum;
  }
  // Calls visit(row, column, value) for each number of the pair's second derivative [N/m].
  template <class Visit>
  void for_each_entry(const Visit& visit) const {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) visit(vertex[i], vertex[j], stiffness * factor[i] * factor[j]);
    }
  }
};

// Holds all pairs of a model.
struct Seams {
  struct Share {
    std::int32_t pair;
    double factor;  // of the vertex in this pair's d
  };
  std::vector<SeamPair> pairs;
  std::vector<std::int32_t> begin;  // by vertex: where its shares begin, and the end; empty without pairs
  std::vector<Share> shares;

  bool empty() const { return pairs.empty(); }
  // Returns the shares of a vertex.
  std::span<const Share> of(std::size_t vertex) const {
    if (empty()) return {};
    return {shares.data() + begin[vertex], std::size_t(begin[vertex + 1] - begin[vertex])};
  }
  // Lists the shares of each vertex. Must be called once the pairs are there.
  void index(int vertices);
};

// Says which share of the gaps at the start is left in the seams of a part.
struct SeamOpening {
  double end = 1, middle = 1;  // s at the end of a step and at its middle
};

// Returns s at a time of a film. seam_time: when the seam is closed [s].
double seam_opening(double time, double seam_time);

// Writes s D for each pair of a model (pairs x 3) [m]. openings: by part; empty: all gaps are as at the start.
void open_gaps(const Model& model, const std::vector<SeamOpening>& openings, double SeamOpening::*when,
               Positions& gaps);

// Holds e times the energy of seams, or its difference from that at a reference, and its slope along a direction [J].
struct SeamChange {
  double value = 0, slope = 0;
};

// Adds the gradient of the seams' energy at `place` to `gradient` (n_free x 3; null: only the value is wanted). Returns
// e times the energy, or its difference from that at a reference (null: none), and the slope along the direction
// (n_free x 3).
SeamChange add_seams(const Model& model, const Positions& gaps, const double* place, const double* reference,
                     const Positions& direction, Positions* gradient);

// Returns the energy of the seams at x [J].
double seam_energy(const Model& model, const Positions& gaps, const Positions& x);

// Returns the work of the seams' forces at x on held vertices along their ways from q [J].
double seam_work_on_held(const Model& model, const Positions& gaps, const Positions& x, const Positions& q);

// Returns how far the gap of a pair at x (n x 3) is at most from the gap that is meant to be there [m].
double widest_seam(const Model& model, const Positions& gaps, const Positions& x);

// Lists the vertices that seams join, in the numbering of the pairs.
std::vector<JoinedVertices> joined_by_seams(const std::vector<SeamPair>& pairs);

// Does the same for a part of a model, in the part's own numbering.
std::vector<JoinedVertices> joined_by_seams(const Model& model, const Part& part);

}  // namespace supple
