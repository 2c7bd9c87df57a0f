// Tells which parts of a surface make one body, those that overlap, touch, or lie in one another, and measures volumes
// inside closed surfaces.
#pragma once

#include "geometry/solids/solid_surface.h"

namespace supple {

enum class Joining {
  near,      // parts that overlap, or are nearer to each other than a gap, make one piece
  cavities,  // each part is a piece of its own; only cavities belong to what is around them
};

struct SurfacePieces {
  std::vector<SolidSurface> pieces;  // by volume, the largest first
  std::vector<double> volumes;       // of each piece; what overlaps counts once [m^3]
  bool touching = false;             // whether parts of a piece are near each other without an overlap
};

// Takes a solid's surface apart; the gap is in metres. What is drawn goes with the piece that it is nearest to.
SurfacePieces pieces_of(SolidSurface surface, Joining joining, double gap);

// Returns the closed parts of a boundary, each with its own vertices.
std::vector<TriMesh> closed_parts(const TriMesh& boundary);

// Returns the volume that a closed surface encloses; it is negative where the surface faces inward [m^3].
double enclosed_volume(const TriMesh& boundary);

// Returns the volume where the winding number is positive, so that what is inside twice counts once [m^3]. It is summed
// up over columns through the surface, some 250 across. Each column is measured exactly, so that errors are some
// thousandths. boundary: closed, facing outward, cavities facing into themselves.
double united_volume(const TriMesh& boundary);

}  // namespace supple
