// Tells whether a triangle surface encloses a volume, and how large it is. Only such a surface can hold gas. Not here:
// closing a surface that is open (geometry/solids/).
#pragma once

#include <string>

#include "base/types.h"

namespace supple {

// Returns why a surface encloses nothing, as the end of "its surface ..."; empty where it encloses a volume. Each edge
// must be passed as often in one direction as in the other. x: n x 3 [m].
std::string why_not_closed(const Triangles& triangles, const Positions& x);

// Returns the volume that `count` triangles from `first` on enclose; negative where they are anticlockwise as seen from
// inside [m^3]. Coordinates are taken relative to a vertex of the surface, so that a surface far from the origin keeps
// its digits.
double signed_volume(const Triangles& triangles, Eigen::Index first, Eigen::Index count, const Positions& x);

}  // namespace supple
