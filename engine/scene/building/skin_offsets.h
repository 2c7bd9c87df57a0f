// Finds which place of a body's drawn skin touches colliders in the stead of each vertex of its elements' surface, so
// that the skin stands on the ground also where the elements reach beyond it, or stay within it.
#pragma once

#include "scene/building/body.h"

namespace supple {

// Returns by vertex of a body's mesh the way to the place that touches in its stead, at rest, n x 3 [m]. For a body
// made from a surface, this is the place that lies furthest out among those to which the vertex is the nearest one; a
// vertex that is nearest to none has the place that is nearest to it. For a body made from a shape, it is the place of
// the shape that is nearest to the vertex. Zero inside the body. Empty where the elements themselves are drawn. The
// body must be placed.
Positions skin_offsets(const Body& body);

}  // namespace supple
