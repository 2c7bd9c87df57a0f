// Finds where the lines of a surface (feature_lines.h) have corners.
#pragma once

#include <vector>

#include "geometry/triangles/feature_lines.h"

namespace supple {

// Returns the places in a row of vertices, in increasing order, at which the line has a corner: where it turns sharply,
// at the vertices that `is_corner` flags, and at its ends where it is open. A closed row names its first vertex again
// at its end, and the result does not; it gets at least two corners. The turn at a vertex is the angle between two
// ways: the one to the vertex from the line's point a window before it, and the one from the vertex to the point a
// window after it. So a jagged line has no corners at its teeth, and a small rounded corner is one. Of the turns within
// half a window, the largest counts.
std::vector<std::size_t> line_corners(const std::vector<std::int32_t>& row, const Positions& points,
                                      const std::vector<char>& is_corner, const FeatureLimits& limits);

}  // namespace supple
