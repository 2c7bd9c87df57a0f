// Keeps what is printed on a surface in its place when the surface is subdivided. The weights themselves come from
// loop_subdivision.h.
#pragma once

#include "geometry/skins/skin.h"
#include "geometry/skins/surface_weights.h"

namespace supple {

// Moves the vertices of a subdivided skin on the flat cloth, in the pattern and in the texture as they have moved in
// space: where the neighbours of a vertex do not lie evenly around it, it slides along the surface. Along seams, where
// a vertex of the mesh has several such places, nothing moves. vertex_of: mesh vertex by skin vertex, before the skin
// was subdivided. vertices: the number of the mesh's vertices.
void slide_on_flat(const SurfaceWeights& weights, const std::vector<std::int32_t>& vertex_of, Eigen::Index vertices,
                   Skin& skin);

}  // namespace supple
