// Carries the colours of a file's triangles to what is drawn of them: the surface is repaired, taken apart and refined
// in between, and its triangles find their colours again by their places, or by where their corners came from
// (file_corners.h).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "geometry/files/colored_surface.h"
#include "geometry/skins/file_corners.h"
#include "geometry/skins/skin.h"

namespace supple {

// Holds the colours of a surface.
struct SurfaceColors {
  std::vector<std::array<SurfaceColor, 3>> corners;  // by triangle
  Textures textures;
  std::uint64_t hash = 0;  // of all of this
};

// Returns the colours of a surface that was made from the file's triangles, in the same frame; null where the file has
// none. A triangle with the corners of one of the file's has its colours. Others, such as those that close a hole, have
// those of the nearest triangle.
std::shared_ptr<const SurfaceColors> colors_on(const TriMesh& surface, const ColoredSurface& file);

// Returns the colours of a surface whose corners come from known places in the file; null where the file has none.
std::shared_ptr<const SurfaceColors> colors_on(const FileCorners& corners, const ColoredSurface& file);

// Returns the parts of a surface's triangles, which find theirs as colors_on finds colours; null where no part of the
// file has a name.
std::shared_ptr<const SurfaceParts> parts_on(const TriMesh& surface, const ColoredSurface& file);

// Returns the texture coordinates of a surface's corners, which find theirs as colors_on finds colours; null where the
// file has none.
std::shared_ptr<const TextureCorners> places_on(const TriMesh& surface, const ColoredSurface& file);

// Returns the colour at a place of a triangle in sRGB, each channel 0 to 1. weights: barycentric.
Vec3 srgb_at(const SurfaceColors& colors, Eigen::Index triangle, const Vec3& weights);

// Returns how bright the pixel of a picture is that lies at a place of it, 0 black to 1 white: the luma of BT.709, of
// the sRGB numbers. The picture repeats beyond its edges, which both belong to it.
double brightness_at(const Texture& picture, const Eigen::Vector2d& place);

// Gives a skin that skin_of_surface has made of these triangles the colours of their corners. Vertices at which colours
// meet are split; those that were one keep one normal (Skin::smooth). Returns the vertex that each was before.
std::vector<std::int32_t> put_on_colors(Skin& skin, const TriMesh& surface, const SurfaceColors& colors);

// Makes the skin of a coloured surface as skin_of_surface does, after it has been refined (refine_surface.h). Vertices
// at which colours meet are split; those that were one keep one normal (Skin::smooth).
Skin colored_skin(const TriMesh& surface, const SurfaceColors& colors, double longest, Eigen::Index most,
                  double square);

}  // namespace supple
