// Defines what the file of a surface says of its colours.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/texture.h"
#include "geometry/meshes/mesh.h"

namespace supple {

using Textures = std::shared_ptr<const std::vector<Texture>>;  // null: there are none

// Holds what a file says, with the vertices that it has there.
struct ColoredSurface {
  TriMesh mesh;
  std::vector<SurfaceColor> colors;  // by vertex; empty where the file has no colours
  Textures textures;
  std::vector<std::string> remarks;  // on colours that are missing or not drawn
  std::string found;                 // which colours there are, in words; empty: none
};

}  // namespace supple
