// Tells where the corners of a cloth's triangles come from: the places that they had in the file's triangles before the
// surface was welded and remeshed. So what the file says of its triangles can be read at the corners. Not here:
// surfaces that were closed or cut, whose triangles find the file's by their places (surface_colors.h).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "geometry/files/colored_surface.h"
#include "geometry/triangles/remesh.h"
#include "geometry/triangles/welded_surface.h"

namespace supple {

// By triangle and corner: the place in the triangles of the file. A triangle's three places have one part and one
// texture.
using FileCorners = std::vector<std::array<RemeshedPlace, 3>>;

// Returns where the corners of a welded surface lie in the surface that was welded.
FileCorners corners_in(const TriMesh& raw, const WeldedSurface& welded);

// Returns where the corners of a remeshed surface lie in the file. before: those of the surface that was remeshed.
FileCorners corners_in(const FileCorners& before, const RemeshedSurface& remeshed);

// Returns the edges between two triangles at which the file's texture coordinates jump, or its parts meet: two vertices
// each, the lower one first and in increasing order. Where remeshing keeps them as lines (RemeshOptions), what the file
// says on one side of them stays apart from what it says on the other. In a texture in which each triangle lies apart,
// they are all edges.
std::vector<std::array<std::int32_t, 2>> file_seams(const TriMesh& surface, const FileCorners& corners,
                                                    const ColoredSurface& file);

// Returns the texture coordinates at a place; not a number where the file has none.
Eigen::Vector2d texture_place(const RemeshedPlace& place, const ColoredSurface& file);

// Holds the texture coordinates of the corners of triangles, by triangle.
using TextureCorners = std::vector<std::array<Eigen::Vector2d, 3>>;

// Returns the texture coordinates of triangles by where their corners come from; null where the file has none.
std::shared_ptr<const TextureCorners> places_on(const FileCorners& corners, const ColoredSurface& file);

// Returns the parts of triangles by where their corners come from; null where no part of the file has a name.
std::shared_ptr<const SurfaceParts> parts_on(const FileCorners& corners, const ColoredSurface& file);

}  // namespace supple
