// Takes triangles that hang together as the boundary of a solid, without moving any of them.
#pragma once

#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Returns the same triangles as the boundary of a solid. Equal positions become one vertex; triangles without area or
// listed twice are left out; all triangles face outward, and those of a cavity face into it. A component that lies
// wholly in another one is a cavity if it is turned the other way. Holes are tolerated if together they cover at most 2
// % of a component's area. Everything that was changed or is odd is added to `notes`, which may be null. Throws
// InputError, with a triangle's place and its number in `raw` from 1, for open surfaces, edges with three triangles or
// more, one-sided surfaces, components that enclose no volume, numbers that are not finite, and indices out of range.
TriMesh closed_surface(TriMesh raw, const std::string& name, std::vector<std::string>* notes);

}  // namespace supple
