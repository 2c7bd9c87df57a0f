// Finds the bodies of a scene that are in the same place. Bodies do not collide with each other: where they meet, they
// pass through each other, and whoever makes the film should know that: the warning is `overlap`. Not here: what a body
// does with rigid colliders (overlaps.h, sim/contact/).
#pragma once

#include <array>
#include <vector>

#include "scene/building/body.h"

namespace supple {

class BodyMeetings {
 public:
  // bodies: the bodies of the scene; they must outlive this object. With one body nothing is computed.
  explicit BodyMeetings(const std::vector<Body>& bodies);

  // Leaves a pair out of find() from now on.
  void leave_out(std::size_t a, std::size_t b);
  bool none_left() const { return left_ == 0; }

  // Returns the pairs that share space in these positions, the earlier body first, and leaves them out from now on.
  // points: the positions of each body's mesh, n x 3 [m].
  std::vector<std::array<std::size_t, 2>> find(const std::vector<Positions>& points);

 private:
  const Triangles& surface_of(std::size_t body);

  const std::vector<Body>& bodies_;
  std::vector<Triangles> surfaces_;  // surface of each body, once they are needed
  std::vector<char> looked_for_;     // by pair
  std::size_t left_ = 0;             // number of pairs that find() still looks for
};

}  // namespace supple
