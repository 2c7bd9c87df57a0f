// Gives the surface of a body's mesh: the triangles of a cloth, or the boundary of a solid. Not here: the skin that is
// drawn in its place (drawn_body.h).
#pragma once

#include "scene/building/assemble.h"

namespace supple {

// Returns the triangles of a body's surface, by vertex of its mesh.
Triangles surface_of(const Body& body);

}  // namespace supple
