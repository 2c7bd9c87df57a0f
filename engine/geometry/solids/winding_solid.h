// Makes a closed surface of any triangles that have an inside, however they hang together. The inside is where the
// generalised winding number exceeds 1/2 (sign_grid.h); the boundary of that is moved onto the triangles where they are
// near, and is smooth where they leave holes.
#pragma once

#include "base/threads.h"
#include "geometry/triangles/numbered_surface.h"

namespace supple {

struct WindingSolid {
  TriMesh boundary;         // closed, a manifold, facing outward
  TriMesh drawn;            // the triangles that can be seen, and what closes their holes
  double cell = 0;          // edge of the grid's cells, below which the boundary has no detail [m]
  Eigen::Index turned = 0;  // how many triangles face the other way than in the file
  double hidden = 0;        // share of the triangles' area that lies inside and is not drawn
  double loose = 0;         // share of the triangles' area that bounds nothing: sheets with the outside on both sides
  double patched = 0;       // share of the boundary's area that closes holes
};

// Makes the solid of a cleaned surface. Throws InputError, with this name, when there is no inside to speak of.
WindingSolid winding_solid(const Numbered& surface, const std::string& name, Threads& threads);

// Orients the parts of a surface that hang together by edges of two triangles: each as most of it faces in the file,
// but outward where rays from its two sides tell clearly which of them is outside: Takayama, Jacobson, Kavan,
// Sorkine-Hornung, A simple method for correcting facet orientations in polygon meshes based on ray casting, 2014.
// Returns how many triangles were turned.
Eigen::Index orient_parts(Numbered& surface, Threads& threads);

}  // namespace supple
