// Writes a surface with the colours of the file that it was made from: as Wavefront OBJ with texture coordinates and
// colours of vertices, with its materials (MTL) and textures (PNG) beside it.
#pragma once

#include <filesystem>
#include <vector>

#include "base/texture.h"
#include "base/types.h"

namespace supple {

struct ColoredObj {
  const Positions& points;
  const Triangles& triangles;
  const std::vector<SurfaceColor>& colors;  // by vertex
  const std::vector<Texture>* textures;     // null: there are none
  Vec3 origin = Vec3::Zero();               // see write_obj (obj_file.h)
};

// Writes NAME.obj, NAME.mtl and NAME-0.png and so on, where the path is NAME.obj. The vertices and their order are
// those of write_obj; each has one place in its texture, of the same number. Throws RunError when the disk refuses.
void write_colored_obj(const std::filesystem::path& path, const ColoredObj& surface);

}  // namespace supple
