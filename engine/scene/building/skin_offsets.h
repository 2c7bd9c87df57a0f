// Finds which place of a body's drawn skin touches colliders in the stead of each vertex of its elements' surface, so
// that the skin stands on the ground also where the elements reach beyond it, or stay within it.
#pragma once

#include "scene/building/body.h"

namespace supple {

// Returns by vertex of a body's mesh the way to such a place at rest, n x 3 [m]. Among the places of the skin to which
// the vertex is the nearest one, it is the one that lies furthest out; a vertex that is nearest to none has the place
// that is nearest to it. Zero inside the body. Empty where the elements themselves are drawn. The body must be placed.
Positions skin_offsets(const Body& body);

}  // namespace supple
