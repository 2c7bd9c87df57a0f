// Measures how far the drawn skin of a body reaches beyond its elements, so that contact keeps skins apart, not
// elements.
#pragma once

#include "scene/building/body.h"

namespace supple {

// Returns by vertex of a body's mesh how far its skin reaches beyond the elements' surface, along the surface's normal
// [the file's units]: the largest value in the triangles at the vertex, because between vertices that lie on it a round
// skin bulges beyond flat triangles. A place counts as 0 where the surface lies outside the skin, and where the skin is
// further away than 1 % of the body's size: thin parts without elements would keep others far away. No place counts as
// more than 0.4 %. The values are smoothed along the surface, because a step cannot foresee how they change there.
// Empty where the elements themselves are drawn. The body's mesh must be in the file's frame.
std::vector<double> skin_overhang(const Body& body);

}  // namespace supple
