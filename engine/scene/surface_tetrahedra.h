// Makes the tetrahedra of a body from a surface that somebody else made: inside it where they fit, smaller where it is
// thin, or around it where it is too thin or too loose.
#pragma once

#include <string>
#include <vector>

#include "geometry/shape.h"
#include "geometry/solid_surface.h"
#include "geometry/surface_thickness.h"
#include "scene/making.h"

namespace supple {

// Tells what of a surface is thinner than an element of a uniform mesh.
struct Thinness {
  double spacing = 0;                    // of the uniform lattice with the wanted number of vertices
  double wanted = 0;                     // vertices that resolve nearly all
  double thin_share = 0;                 // of the surface
  std::vector<ThicknessSample> samples;  // the thinnest first; none where the surface has too many triangles for a look
};

Thinness thinness_of(const TriMesh& boundary, int vertices);

// Says which share of the surface is thinner than an element, and which has none inside nevertheless. Returns an empty
// text where neither is worth a word.
std::string thinness_note(const Thinness& thinness, const TetMesh& mesh, int vertices);

struct SurfaceBody {
  const SolidSurface& solid;
  bool touching;       // whether parts are near each other without an overlap, and so may fall apart
  int vertices;        // wanted
  std::string source;  // its name in messages
};

// Throws InputError.
TetMesh surface_tetrahedra(const SurfaceBody& body, const Thinness& thinness, const Making& making);

// Makes tetrahedra of a shape, and tells of the progress. swell: as for tetrahedralize. Throws InputError.
TetMesh shape_tetrahedra(const Shape& shape, int vertices, const std::string& source, const Making& making,
                         double swell = 0);

}  // namespace supple
