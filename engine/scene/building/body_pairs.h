// Holds the pairs of a scene's bodies that a search still looks for, and finds those of them that are near each other.
// What is then asked of a pair is in body_passings.h and body_depths.h.
#pragma once

#include <vector>

#include "geometry/meshes/shared_space.h"
#include "scene/building/body.h"

namespace supple {

enum class PairKind {
  meeting,  // the bodies meet (scene/definition/meeting.h), and one of them has an inside
  passing,  // they do not meet, or are two cloths: where they share space, they pass through each other
};

// A pair is written with the earlier body first. Its kind is that of the bodies' present definitions, which a replay
// may change.
class BodyPairs {
 public:
  // Looks for all pairs. bodies: the bodies of the scene; they must outlive this object.
  explicit BodyPairs(const std::vector<Body>& bodies);

  // Leaves a pair out from now on.
  void leave_out(std::size_t a, std::size_t b) { look_for(a, b, false); }
  // Looks again for a pair that was left out.
  void take_in(std::size_t a, std::size_t b) { look_for(a, b, true); }

  // Tells whether a pair of this kind is looked for.
  bool has(PairKind kind) const;

  struct Near {
    std::size_t a, b;
    PosedMesh mesh_a, mesh_b;  // they refer to the points given to near(), and to this object
  };
  // Returns the pairs of a kind that are looked for and whose boxes overlap in these positions. points: the positions
  // of each body's mesh, n x 3 [m].
  std::vector<Near> near(PairKind kind, const std::vector<Positions>& points);

 private:
  void look_for(std::size_t a, std::size_t b, bool wanted);
  bool looks_for(std::size_t a, std::size_t b, PairKind kind) const;
  const Triangles& surface_of(std::size_t body);

  const std::vector<Body>& bodies_;
  std::vector<Triangles> surfaces_;  // surface of each body, once it is needed
  std::vector<char> looked_for_;     // by pair: whether it is looked for
};

}  // namespace supple
