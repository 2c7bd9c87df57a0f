// Measures how much a triangle surface is curved at its vertices. Open borders and folded triangles are allowed.
#pragma once

#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Returns the mean of the two principal curvatures at each vertex: positive where the surface is hollow on the side
// from which its triangles run anticlockwise, 0 at vertices without triangles [1 / m].
std::vector<double> mean_curvature(const Positions& points, const Triangles& triangles);

// Replaces the value of each vertex by the mean of it and of its neighbours' mean, `rounds` times.
void smooth_values(const Triangles& triangles, int rounds, std::vector<double>& values);

}  // namespace supple
