// Finds where the lines of a surface (feature_lines.h) have corners.
#pragma once

#include <vector>

#include "geometry/triangles/feature_lines.h"

namespace supple {

// Returns the places in a row of vertices, in increasing order, where the line has a corner: where it turns sharply,
// and its ends where it is open. A closed row names its first vertex again at its end, which no result does; it gets at
// least two corners. The turn at a vertex is the angle between the ways
// from the line's point a window before it and to the point a window after it, so that a jagged line has no corners at
// its teeth, and a small rounded corner is one; of the turns within half a window the largest counts.
std::vector<std::size_t> line_corners(const std::vector<std::int32_t>& row, const Positions& points,
                                      const std::vector<char>& is_corner, const FeatureLimits& limits);

}  // namespace supple
