// Measures skins against the elements below them: their lengths at rest, and whether they stretch alike.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

// Returns the mean length of one edge of each element [m]; 0 without elements.
double mean_edge(const TetMesh& mesh);

// Names an edge of a skin, and the factor by which it is longer than at rest.
struct StretchedEdge {
  std::int32_t from = -1, to = -1;  // skin vertices
  double factor = 0;
};

// Returns the edge that is stretched most. Edges that are shorter at rest than `shortest` [m] do not count: over such
// lengths, the single precision in which motion is kept would be measured.
StretchedEdge most_stretched_edge(const TriMesh& rest, const Positions& now, double shortest);

// Returns the largest singular value of any element's deformation gradient. No edge inside an element is stretched by
// more than its element's.
double largest_element_stretch(const TetMesh& mesh, const Positions& now);

}  // namespace supple
