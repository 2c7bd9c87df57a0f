// Defines what the file of a surface says of its colours, its texture coordinates and the names of its parts.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/texture.h"
#include "geometry/meshes/mesh.h"

namespace supple {

using Textures = std::shared_ptr<const std::vector<Texture>>;  // null: there are none

using TexturePlace =
    std::array<float, 2>;  // u and v: (0, 0) is the lower left corner of a texture, (1, 1) the opposite one

// Holds the names that a file gives to triangles. A triangle belongs to one part, and a part has the names of its
// material, its group or mesh, and the nodes above.
struct SurfaceParts {
  std::vector<std::vector<std::string>> names;  // by part
  std::vector<std::int32_t> of;                 // number of the part by triangle, or in ColoredSurface by vertex
};

// Holds what a file says of a surface, with the vertices of the file.
struct ColoredSurface {
  TriMesh mesh;
  std::vector<SurfaceColor> colors;  // by vertex; empty where the file has no colours
  Textures textures;
  std::vector<TexturePlace> places;  // by vertex; not a number where there is none; empty where the file has none
  SurfaceParts parts;                // none where nothing has a name
  std::vector<std::string> remarks;  // on colours that are missing or not drawn
  std::string found;                 // which colours there are, in words; empty: none
};

}  // namespace supple
