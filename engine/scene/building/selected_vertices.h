// Finds the vertices that a handle's selection names. Not here: which of them another handle has already
// (assemble.cpp), and how a selection is read (scene/reading/body_reader.cpp).
#pragma once

#include "scene/building/body.h"

namespace supple {

// Returns the vertices, in increasing order, each once. Coordinates are relative to the rest box before the body is
// rotated, so that a selection means the same part in every orientation of the body. Numbers beyond the last vertex are
// left out. Groups, colours and masks are properties of the file's triangles. In a cloth, the corners of a triangle
// have its properties; in a solid, each vertex on the surface of the elements has those of the nearest place of the
// skin.
std::vector<std::int32_t> selected_vertices(const Selection& selection, const Body& body);

// Says why a selection has no vertex, after "selects no vertex".
std::string empty_reason(const Selection& selection, const Body& body);

}  // namespace supple
