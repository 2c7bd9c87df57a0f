// Tells of a mesh that was edited where its vertices lie on the surface from which it came.
#pragma once

#include "geometry/triangles/editable_surface.h"
#include "geometry/triangles/patch_projection.h"
#include "geometry/triangles/remesh.h"
#include "geometry/triangles/welded_surface.h"

namespace supple {

// Returns the triangles that are left of an edited surface, and the places of their vertices. joined: the surface that
// was edited, some of whose triangles may have been turned over. surface: the one from which `joined` was welded.
RemeshedSurface with_places(const EditableSurface& edited, const PatchProjection& projection,
                            const SurfaceFeatures& features, const WeldedSurface& joined, const TriMesh& surface);

}  // namespace supple
