// Makes what is seen where handles hold a body: plates on faces, rings around what is held in the middle, rods along
// edges, pins in single vertices. They are for the eye alone; nothing touches them. Not here: how they are drawn
// (film/pictures/drawn_supports.h).
//
// Supports are chosen by the vertices that a handle holds, at rest, in the directions of the body's file. Held vertices
// inside a body have no support, because it would not be seen.
#pragma once

#include <vector>

#include "scene/building/body.h"

namespace supple {

// Holds the support of vertices that hang together and that one handle holds.
struct Support {
  std::size_t handle;  // its number among the body's handles
  TriMesh surface;     // the support's surface where the body is at rest [m]
};

std::vector<Support> supports_of(const Body& body);

// Returns the rigid motion that takes the vertices that a handle holds from rest to where they are, as nearly as a
// rigid motion can (exactly, where the handle is hard). It follows from the positions alone, so that a film that is
// drawn again has the same supports. now: the positions of the body's mesh [m].
Eigen::Isometry3d motion_of_held(const Body& body, std::size_t handle, const Positions& now);

}  // namespace supple
