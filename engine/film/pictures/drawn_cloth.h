// Decides how cloth is drawn: how fine its surface is, and the sizes of what is woven and sewn. The surface is computed
// in geometry/skins/loop_subdivision.h, the light in shaders/cloth.glsl.
#pragma once

#include "render/draw_list.h"
#include "scene/building/drawn_body.h"

namespace supple {

// Returns how a body looks as cloth; nothing where it is none. rest: places of its mesh at rest, n x 3 [m].
std::optional<ClothLook> cloth_look(const BodyDef& body, const Positions& rest);

// Returns the gloss of a body's uncovered surface, 0 matt to 1 wet. Cloth has less than other bodies.
double gloss_of(const BodyDef& body);

// Subdivides the surface of a cloth until its edges are a few pixels long, at most three times. rest: places of its
// mesh at rest, n x 3 [m]. pixel: the edge of a pixel where the cloth is nearest to a camera [m].
void smooth_for_pixels(DrawnBody& drawn, const Positions& rest, double pixel);

// Returns the place of a vertex of a smooth surface [m]. now: places of the mesh, n x 3 [m].
Vec3 smooth_place(const SurfaceWeights& weights, Eigen::Index row, const Positions& now);

// Returns how hollow the drawn surface of a cloth is at each vertex: from -1 on the ridges of folds to 1 in valleys, as
// seen from the front; empty for other bodies. now: places of the mesh, n x 3 [m].
std::vector<float> cloth_hollows(const DrawnBody& drawn, const Body& body, const Positions& now);

}  // namespace supple
