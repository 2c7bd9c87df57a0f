// Finds bodies that meet (scene/definition/meeting.h) and are nevertheless in each other: those that start so, which
// contact pushes apart, and those that are deep in each other while the film runs. The warning is `overlap`. Not here:
// bodies that pass through each other (body_passings.h), and bodies in colliders (starts_inside.h).
#pragma once

#include <string>
#include <vector>

#include "scene/building/body_pairs.h"

namespace supple {

struct BodyDepth {
  std::size_t a, b;  // the bodies, the earlier one first; equal where a body is in itself
  double depth;      // an estimate (geometry/triangles/shared_depth.h); 0: no vertex of one is inside the other [m]
  double share;      // depth over the size of the smaller body
  Vec3 place;        // place of the deepest vertex [m]
};

// Returns the pairs of bodies that meet and overlap in these positions. An overlap below a ten-thousandth of the
// smaller body's size does not count. points: the positions of each body's mesh, n x 3 [m].
std::vector<BodyDepth> overlaps_of_bodies(const std::vector<Body>& bodies, const std::vector<Positions>& points);

// Returns the solids that meet themselves and are partly inside themselves in these positions, with the deepest point
// of each. points: as above.
std::vector<BodyDepth> bodies_in_themselves(const std::vector<Body>& bodies, const std::vector<Positions>& points);

// Says that two bodies overlap at the start, or that one overlaps itself, and what becomes of the overlap.
std::string start_overlap_text(const std::vector<Body>& bodies, const BodyDepth& overlap);

// Finds, each once, the pairs of bodies that meet and are deep in each other.
class DeepBodies {
 public:
  static constexpr double deep = 0.01;  // over the size of the smaller body

  // bodies: the bodies of the scene; they must outlive this object. With one body nothing is computed.
  explicit DeepBodies(const std::vector<Body>& bodies) : bodies_(bodies), pairs_(bodies) {}

  // Leaves a pair out of find() from now on.
  void leave_out(std::size_t a, std::size_t b) { pairs_.leave_out(a, b); }
  // Lets find() look again for a pair that was left out.
  void take_in(std::size_t a, std::size_t b) { pairs_.take_in(a, b); }
  // Tells whether find() has nothing to look for, as the bodies are defined now.
  bool none_left() const { return !pairs_.has(PairKind::meeting); }

  // Returns the pairs that are deep in each other in these positions, and leaves them out from now on. points: the
  // positions of each body's mesh, n x 3 [m].
  std::vector<BodyDepth> find(const std::vector<Positions>& points);

 private:
  const std::vector<Body>& bodies_;
  BodyPairs pairs_;
};

}  // namespace supple
