// Tells whether two rings are linked, from the positions of their vertices.
#pragma once

#include <vector>

#include "base/types.h"

namespace supple {

// Returns how often two closed curves of straight edges go around each other, with a sign.
double linking_number(const std::vector<Vec3>& one, const std::vector<Vec3>& other);

// Returns the middle line of a ring whose axis is z or x at rest: the means of the vertices of each of 24 sectors.
// rest, x: n x 3 [m].
std::vector<Vec3> middle_line_of_ring(const Positions& rest, const Positions& x);

}  // namespace supple
