// Follows how the directions of a search shrink, and foretells from this how far the search still is from its minimum.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/model/model.h"

namespace supple {

// Keeps the lengths of a search's last directions, for each part of a model. A length is |d|_M (model/motion_error.h)
// [m sqrt(kg)]. Newton's method goes on where L-BFGS ended, so the last directions may be of both.
class DirectionLengths {
 public:
  // Forgets all directions.
  void begin(const Model& model);

  // Adds the direction d (n_free x 3 [m]) of an iteration. accepted: the share of d that the line search took.
  void add(const Model& model, const Positions& d, double accepted);

  // Returns the length of the way that a part still has to go if directions go on shrinking at the rate of the last
  // five: the sum of a geometric series. Returns 0 where this is not known because there were fewer than two directions
  // or one of them had no length.
  double left(std::size_t part) const;

 private:
  static constexpr int most = 5;
  std::vector<std::array<double, most>> lengths_;  // by part, the newest first
  int count_ = 0;
};

}  // namespace supple
