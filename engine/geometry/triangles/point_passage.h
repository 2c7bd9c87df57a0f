// Finds the time at which a point passes through a triangle while the point and the triangle's corners move evenly. At
// that time the four lie in one plane, which makes a cubic equation: Provot, Collision and self-collision handling in
// cloth model dedicated to design garments, 1997; Bridson, Fedkiw, Anderson, Robust treatment of collisions, contact
// and friction for cloth animation, 2002. The cubic's roots lie between its extrema, as in Wang, Ferguson, Schneider,
// Jiang, Attene, Panozzo, A large-scale benchmark and an inclusion-based algorithm for continuous collision detection,
// 2021, section 4. Not here: which triangles a point may meet (moving_surface.h).
#pragma once

#include <array>
#include <optional>

#include "base/types.h"

namespace supple {

// Describes a triangle as it is seen from the point, that is, by the differences of its corners and the point.
struct SeenTriangle {
  std::array<Vec3, 3> start, end;  // anticlockwise from its front [m]
};

struct Passage {
  double share;  // of the way from start to end, 0 to 1
  Vec3 weights;  // barycentric, of the corners; none is negative, and their sum is 1
  Vec3 normal;   // of the triangle at that time, of unit length, toward its front
};

// Returns the first passage from the front to the back, up to the share `latest`. A point that lies on the triangle at
// the start and moves to its back passes at share 0; one that reaches the triangle at the end alone does not pass.
// Places up to a millionth of the triangle's size beside it count as places of it, so that a point which passes through
// an edge or a corner that triangles share is seen by one of them. roundoff: by how much the differences may be wrong;
// a point is behind the triangle where it is further behind than that [m]. A triangle without area is never passed.
std::optional<Passage> first_passage(const SeenTriangle& triangle, double roundoff, double latest);

}  // namespace supple
