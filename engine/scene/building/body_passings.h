// Finds the bodies of a scene that are in the same place although they do not meet (scene/definition/meeting.h), and
// the cloths that cross each other or themselves although they meet. All of these pass through each other, and whoever
// makes the film should know that. The warning is `overlap`. Not here: bodies that meet and are deep in each other
// (body_depths.h), and what a body does with colliders (starts_inside.h, sim/contact/).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "scene/building/body_pairs.h"

namespace supple {

class BodyPassings {
 public:
  // bodies: the bodies of the scene; they must outlive this object. With one body find() computes nothing.
  explicit BodyPassings(const std::vector<Body>& bodies);
  ~BodyPassings();

  // Leaves a pair out of find() from now on or, where both numbers are the same, a cloth out of crosses_itself().
  void leave_out(std::size_t a, std::size_t b);
  // Tells whether find() has nothing to look for, as the bodies are defined now.
  bool none_left() const { return !pairs_.has(PairKind::passing); }

  // Returns the pairs of PairKind::passing that share space in these positions, the earlier body first, and leaves them
  // out from now on. points: the positions of each body's mesh, n x 3 [m].
  std::vector<std::array<std::size_t, 2>> find(const std::vector<Positions>& points);

  // Tells whether a body is a cloth that meets itself and crosses itself in these positions; if so, leaves it out from
  // now on. points: the positions of its mesh, n x 3 [m].
  bool crosses_itself(std::size_t body, const Positions& points);

 private:
  struct Cloth;

  const std::vector<Body>& bodies_;
  BodyPairs pairs_;
  std::vector<std::unique_ptr<Cloth>> cloths_;  // by body, once it is needed
  std::vector<char> left_out_;                  // by body: whether crosses_itself() leaves it out
};

}  // namespace supple
