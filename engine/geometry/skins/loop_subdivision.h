// Subdivides the drawn surface of a cloth so that it looks smooth: Loop's scheme (1987) with the rules of Hoppe et al.
// (1994) for creases, corners and open borders. How many levels a picture needs is decided in film/pictures/.
//
// Loop's surface lies inside of the curves of its control points, so that a cloth would sink into a ball and its
// smallest wrinkles would lose a third of their height. So the control points are first moved outwards by as much as
// the limit surface lies inside: one step of quasi-interpolation, as Litke, Levin and Schroeder (2001, "Fitting
// subdivision surfaces") take it for Catmull and Clark's surfaces. After that, a smooth surface lies inside by little.
#pragma once

#include "geometry/skins/skin.h"
#include "geometry/skins/surface_weights.h"

namespace supple {

// Cuts each triangle of a skin into four, `levels` times. Returns the weights of the mesh's vertices for each vertex of
// the skin. The skin's vertices keep their numbers, and new ones follow.
//
// An edge is sharp where it has another number of triangles than two, or where the skin's vertices are split along it
// (Skin::smooth tells of the vertices that were split for their colours or their print alone). Along sharp edges the
// surface follows a curve that depends on the vertices of that curve alone, so that a seam between two surfaces stays
// closed. A vertex at which more than two sharp edges meet, or two at an angle, stays where it is. Colours, patterns
// and paint change evenly along edges.
//
// vertex_of: mesh vertex by skin vertex. mesh: places of the mesh's vertices at rest, n x 3 [m].
SurfaceWeights subdivide(Skin& skin, const std::vector<std::int32_t>& vertex_of, const Positions& mesh, int levels);

}  // namespace supple
