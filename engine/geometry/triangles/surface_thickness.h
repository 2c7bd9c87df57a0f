// Measures how thick a solid is, seen from places on its surface, and what that means for its tetrahedra.
#pragma once

#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct ThicknessSample {
  double thickness;  // along the inward normal to where the surface is met again [m]
  Vec3 place;        // on the surface [m]
  Vec3 inward;       // direction in which it was measured

  Vec3 middle() const { return place + 0.5 * thickness * inward; }
};

// Tells whether parts of this thickness can lie between the points of a lattice of this spacing.
inline bool is_thin(double thickness, double spacing) { return thickness < 0.7 * spacing; }

// Samples the surface evenly by area; the thinnest place comes first. The surface must be closed and face outward.
std::vector<ThicknessSample> sampled_thickness(const TriMesh& boundary, int count = 2000);

// Returns the spacing of the lattice that makes about this many vertices of a body, from its volume [m^3] and the area
// of its surface [m^2], and the reverse. Two lattice points stand for each cell and one for each face of a cell on the
// surface.
double spacing_for(double volume, double area, double vertices);
double vertices_for(double volume, double area, double spacing);

// Returns how many vertices make the solid at least one cell thick at all but the thinnest twentieth of its surface.
double vertices_wanted(const std::vector<ThicknessSample>& samples, double volume, double area);

double area_of(const TriMesh& mesh);

}  // namespace supple
