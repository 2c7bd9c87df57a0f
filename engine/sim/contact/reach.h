// Tells how far from a surface a point of a body needs a plane before it touches.
#pragma once

#include <algorithm>

namespace supple {

// A point that has moved by `way` since the step began, and would have moved by `freely` if nothing held it, gets a
// plane within this distance of a surface, because an iteration may still move it that much further. A point at rest
// hardly moves, but the next iteration may move it as far as gravity would.
inline double reach_of(double way, double freely) { return 0.25 * std::max(way, freely); }

}  // namespace supple
