// Makes a drawn surface rounder where a picture would show its triangles: without this, the outline of a body and the
// borders of its paint show straight edges, which were fine enough for smaller pictures. The mesh that is simulated
// stays as it is.
#pragma once

#include "geometry/skins/skin.h"

namespace supple {

// Says how far a drawn surface may be from a round one [m].
struct Roundness {
  double edge;  // shorter edges are not cut
  double off;   // nor those whose middle is nearer than this to where it should be
};

// Describes the surface that a skin follows, where it is known.
struct ExactSurface {
  const Shape& shape;
  Eigen::Affine3d from_shape;  // from the shape's frame to the skin's: turned, scaled, moved
};

// Halves the edges of a skin at rest that are long and bent, up to three times over, and returns the two vertices
// between which each new one lies. The skin's vertices keep their numbers, and new ones follow. A new vertex lies on
// the exact surface, with the distances to its layers of paint. Without one it lies on the cubic curve that goes
// through the ends of the edge and is perpendicular to the normals there (Vlachos, Peters, Boyd and Mitchell 2001,
// "Curved PN triangles", section 3.1), and edges stay straight at which the surface has two normals or ends. exact:
// null where it is not known.
//
// With an exact surface, edges across which the border of a layer bends by more than `off` are cut, too.
std::vector<std::array<std::int32_t, 2>> round_off(Skin& skin, const Roundness& roundness, const ExactSurface* exact);

}  // namespace supple
