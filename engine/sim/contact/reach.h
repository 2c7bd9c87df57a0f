// Tells how far from a surface a point of a body needs a plane before it touches.
#pragma once

#include <algorithm>

namespace supple {

// Returns the distance from a surface within which a point gets a plane [m]. way, freely: how far the point has moved
// since the step began, and how far it would have moved if nothing held it [m]. An iteration may still move it that
// much further: a point at rest hardly moves, but the next iteration may move it as far as gravity would.
inline double reach_of(double way, double freely) { return 0.25 * std::max(way, freely); }

}  // namespace supple
