// Finds the bodies of a scene that are in the same place although they do not meet (scene/definition/meeting.h), and
// the cloths that cross each other although they do: they pass through each other, and whoever makes the film should
// know that. The warning is `overlap`. Not here: bodies that meet and are deep in each other (body_depths.h), and what
// a body does with rigid colliders (overlaps.h, sim/contact/).
#pragma once

#include <array>
#include <vector>

#include "scene/building/body_pairs.h"

namespace supple {

class BodyPassings {
 public:
  // bodies: the bodies of the scene; they must outlive this object. With one body nothing is computed.
  explicit BodyPassings(const std::vector<Body>& bodies) : pairs_(bodies) {}

  // Leaves a pair out of find() from now on.
  void leave_out(std::size_t a, std::size_t b) { pairs_.leave_out(a, b); }
  // Tells whether find() has nothing to look for, as the bodies are defined now.
  bool none_left() const { return !pairs_.has(PairKind::passing); }

  // Returns the pairs of PairKind::passing that share space in these positions, the earlier body first, and leaves them
  // out from now on. points: the positions of each body's mesh, n x 3 [m].
  std::vector<std::array<std::size_t, 2>> find(const std::vector<Positions>& points);

 private:
  BodyPairs pairs_;
};

}  // namespace supple
