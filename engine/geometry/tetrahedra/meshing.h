// Decides how the solid inside a surface or a shape becomes tetrahedra: by which lattice (tetrahedralize.h), how far
// the number of vertices may be from the wanted one, which parts may be lost or swollen, and what is to be said of all
// that. Meshes are kept from run to run.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/slow_work.h"
#include "geometry/shapes/shape.h"
#include "geometry/solids/solid_surface.h"

namespace supple {

struct WantedMesh {
  int vertices;
  std::string source;   // the name of the surface or shape in messages
  std::string content;  // a name for the content of its files: the mesh is kept under this and the number
};

struct MadeMesh {
  TetMesh mesh;
  std::vector<std::string> notes;  // a line each, such as what is thin and how far elements reach beyond the surface
};

struct SurfaceBody {
  const SolidSurface& solid;
  bool touching;  // whether parts are near each other without an overlap, and so may fall apart
};

// Makes tetrahedra of the solid inside a surface, or finds them among those that were kept. Throws InputError.
MadeMesh mesh_of_surface(const SurfaceBody& body, const WantedMesh& wanted, const SlowWork& work);

// Does the same for a shape, whose tags the mesh has. Throws InputError.
MadeMesh mesh_of_shape(const Shape& shape, const WantedMesh& wanted, const SlowWork& work);

// These two convert a mesh with its notes to bytes and back; kept_or_made (base/slow_work.h) calls them to keep meshes
// on the disk. The second returns nothing when the bytes are not those of a mesh with notes.
std::string bytes_of(const MadeMesh& made);
std::optional<MadeMesh> made_mesh_from(std::string_view bytes);

}  // namespace supple
