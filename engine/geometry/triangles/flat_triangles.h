// Mends what a triangle without area would leave behind: where one corner lies on the side between the other two, and
// the triangle is left out, the surface beyond that side would be torn off.
#pragma once

#include "geometry/triangles/numbered_surface.h"

namespace supple {

// Leaves out flat triangles with three different corners, and cuts each triangle that shares the longest side of one in
// two, at the corner that lies on that side; both parts have the number of the whole. A flat triangle stays where no
// other one shares that side. Passes are repeated, because a part can be flat too, but at most a dozen times.
Numbered with_flat_triangles_mended(Numbered surface);

}  // namespace supple
