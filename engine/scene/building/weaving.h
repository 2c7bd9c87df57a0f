// Makes the elements of a cloth from its triangles: springs, or triangles that lie flat. Not here: where the triangles
// come from (cloth_body.h), and what a fabric is (scene/reading/fabric_reader.cpp).
#pragma once

#include "scene/building/body.h"

namespace supple {

// Sets the elements, the surface, and the mass at each vertex, of a body of cloth that has its place in the world. May
// be called again when the definition's numbers have changed.
void weave(Body& body);

}  // namespace supple
