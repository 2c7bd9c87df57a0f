// Computes where the vertices of a cloth lie on the flat cloth, for what is woven and sewn there: yarns run along the
// two axes, and a hem along the open borders. How these look is in shaders/cloth.glsl.
#pragma once

#include "geometry/skins/skin.h"

namespace supple {

// Returns the place of each vertex of a skin. mesh_vertex: a number for each vertex of the skin; vertices at one place,
// at which the skin is only split, share a number. square: the edge of the squares in which Skin::square counts [m].
// The distance to the border is measured at rest, and is `no_border` where none can be reached along the surface.
std::vector<FlatPlace> flat_places(const Skin& skin, const std::vector<std::int32_t>& mesh_vertex, double square);

}  // namespace supple
