// Makes, from any triangle surface, the mesh that cloth needs, of triangles with nearly equal sides: the surface of a
// file has long thin triangles, or far too many. The method is that of Botsch and Kobbelt 2004, "A remeshing approach
// to multiresolution modeling", section 4. It does not close holes, make solids (solids/solid_surface.h), or follow
// curvature: all edges get one length.
//
// Debian 12 has no library that could do this here: CGAL's isotropic_remeshing and Gmsh are under the GPL, OpenMesh has
// no remesher, meshoptimizer only removes vertices, and libigl, geogram and the pmp-library are not packaged. CGAL's,
// OpenMesh's and the pmp-library's meshes have no edges with three triangles, which are where the panels of a garment
// meet.
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct RemeshOptions {
  double edge_length = 0;  // wanted [m]
  // Between triangles whose normals differ by more, the edge is a crease and stays; with pi or more there are none.
  // Creases that hang together count only where they are longer than two edges [rad].
  double crease_angle = std::numbers::pi / 3;
  // A border or another line that turns by more has a corner, which stays where it is. The turn is measured over half
  // an edge length to either side [rad].
  double corner_angle = std::numbers::pi / 4;
  // Further edges that stay as lines, two vertices of the surface each; former_seams (welded_surface.h) names those of
  // a texture.
  std::vector<std::array<std::int32_t, 2>> lines = {};
  int rounds = 8;  // of splits, collapses, flips and relaxation
};

// Names a place on the input surface.
struct RemeshedPlace {
  std::int32_t triangle;  // of the surface that was remeshed
  Vec3 weights;           // barycentric, of that triangle's corners; none is negative, and their sum is 1
};

struct RemeshedSurface {
  TriMesh mesh;
  // By vertex: where it lies on the input. At a fold that is too sharp for the new edges and no crease, a vertex that
  // would turn triangles over stays off the input, and this is the nearest place.
  std::vector<RemeshedPlace> places;
  // By triangle and corner: where the vertex lies on the input, in a triangle of the input that is on this triangle's
  // side of each line. What jumps at a line, such as the coordinates of a texture at its seams, is interpolated at
  // these places.
  std::vector<std::array<RemeshedPlace, 3>> corners;
};

// Remeshes a surface. Vertices at the same position are one (welded_surface.h joins near ones); triangles without area
// and repeated ones are left out. All triangles of a part that hangs together face as most of its area does; where a
// one-sided surface turns over, a line stays. So do open borders, edges with three triangles or more, creases, and the
// named lines: their vertices move along them only. Corners of lines, their ends and meeting points, and vertices at
// which sheets touch stay where they are, so that edges are shorter where these are nearer to each other than the
// wanted length. The same input gives the same bits.
//
// Throws InputError, with this name, where the edge length is not positive and finite or an angle is not positive,
// where welded would (welded_surface.h), where a named line is no edge of the surface, and where the new mesh would
// have more than about ten million triangles.
RemeshedSurface remeshed(const TriMesh& surface, const RemeshOptions& options, const std::string& name);

}  // namespace supple
