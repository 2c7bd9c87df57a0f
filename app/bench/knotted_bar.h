// Tells whether a bar is knotted, from the positions of its vertices.
#pragma once

#include <vector>

#include "base/types.h"

namespace supple {

// Returns the determinant of the knot that an open curve of straight edges makes when its ends are led away far
// outside: 1 for a curve that can be pulled straight, 3 for an overhand knot. It is the determinant of the equations
// that colours of the knot's diagram obey (Livingston 1993, "Knot theory", chapter 3). Different knots may have the
// same one. The ends must lead outward. line: at least two points [m].
int knot_determinant(const std::vector<Vec3>& line);

// Returns the middle line of a bar: the means of the vertices in each of 80 shells of distance from one end, along the
// surface at rest. That end is at the largest first coordinate at rest. triangles: the bar's surface. rest, x: n x 3
// [m].
std::vector<Vec3> middle_line_of_bar(const Triangles& triangles, const Positions& rest, const Positions& x);

}  // namespace supple
