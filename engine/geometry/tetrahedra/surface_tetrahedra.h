// Makes the tetrahedra of a body from a surface that somebody else made: inside it where they fit, smaller where it is
// thin, or around it where it is too thin or too loose.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/slow_work.h"
#include "geometry/shapes/shape.h"
#include "geometry/solids/solid_surface.h"

namespace supple {

struct SurfaceBody {
  const SolidSurface& solid;
  bool touching;       // whether parts are near each other without an overlap, and so may fall apart
  int vertices;        // the number of vertices that is wanted
  std::string source;  // the name of the surface in messages
};

struct SurfaceMesh {
  TetMesh mesh;
  std::vector<std::string> notes;  // a line each: what is thin, and how far elements reach beyond the surface
};

// Throws InputError.
SurfaceMesh surface_tetrahedra(const SurfaceBody& body, const SlowWork& work);

// These two convert a mesh with its notes to bytes and back; kept_or_made (base/slow_work.h) calls them to keep meshes
// on the disk. The second returns nothing when the bytes are not those of a mesh with notes.
std::string bytes_of(const SurfaceMesh& made);
std::optional<SurfaceMesh> surface_mesh_from(std::string_view bytes);

// Makes tetrahedra of a shape, and tells of the progress. Throws InputError.
TetMesh shape_tetrahedra(const Shape& shape, int vertices, const std::string& source, const SlowWork& work);

}  // namespace supple
