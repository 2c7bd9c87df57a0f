// Changes a mesh until its edges have one length: the steps of Botsch and Kobbelt 2004, "A remeshing approach to
// multiresolution modeling", section 4. What goes in and comes out is in remesh.h.
#pragma once

#include "geometry/triangles/editable_surface.h"
#include "geometry/triangles/patch_projection.h"

namespace supple {

// Splits edges that are longer than `longest` [m], the longest first.
void split_long_edges(EditableSurface& surface, double longest);

// Collapses edges that are shorter than `shortest` [m], the shortest first, as long as none becomes longer than
// `longest` [m].
void collapse_short_edges(EditableSurface& surface, double shortest, double longest);

// Flips edges as long as this brings the numbers of triangles around vertices nearer to those that are wanted: six
// inside a patch, three on each side of a line, and `wanted` at a corner, by vertex of the input.
void flip_toward_regular(EditableSurface& surface, const std::vector<double>& wanted);

// Flips edges where that makes the smallest angle of their two triangles larger.
void flip_toward_wide_angles(EditableSurface& surface);

// Moves each vertex toward the middle of its neighbourhood, along its line or in its tangent plane, and back to its
// patch.
void relax(EditableSurface& surface, const PatchProjection& projection);

}  // namespace supple
