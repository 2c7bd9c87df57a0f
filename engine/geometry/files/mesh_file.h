// Reads and writes tetrahedral meshes in the formats in which they come from outside: MEDIT (.mesh), Gmsh 2.2 and 4.1
// (.msh), TetGen (.node and .ele), VTK (.vtk and .vtu). Everything that is read is checked; every refusal names the
// file and the line. Surfaces (surface_file.h) and scenes are read elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

inline constexpr char mesh_formats[] = "MEDIT .mesh, Gmsh .msh, TetGen .node and .ele, VTK .vtk and .vtu";

struct MeshFile {
  TetMesh mesh;
  // Holds remarks on what was changed or is unusual, such as a flipped orientation or vertices that no element uses.
  std::vector<std::string> notes;
};

// Tells whether the name's ending is one of those above.
bool is_mesh_file(const std::filesystem::path& path);

// Reads a tetrahedral mesh; its region tags are the file's element references (physical groups of Gmsh, the attribute
// of TetGen, cell data called `region` of VTK). A file with another ending is taken for MEDIT. Throws InputError when
// the file is not a mesh, announces more or fewer rows than it holds, or has indices out of range, numbers that are not
// finite, elements without volume, elements listed twice, or elements of both orientations.
MeshFile read_mesh(const std::filesystem::path& path);

// Checks a mesh that a program has made, as read_mesh() checks files, and turns all elements where all of them are
// negative. name: what messages call it. first: the number of the first element and vertex in messages. Throws
// InputError, also for vertices of no element.
TetMesh checked_mesh(TetMesh mesh, const std::string& name, int first = 1);

// Reads the Triangles of a MEDIT file, for cloth, and ignores its elements. Vertices that no triangle uses are left
// out. Throws InputError as above, and for triangles without area or listed twice.
TriMesh read_surface(const std::filesystem::path& path);

// Writes a mesh in the format of the name's ending (for TetGen both files), with seventeen significant digits, so that
// reading gives the same doubles back. Throws InputError for other endings, and RunError when a file cannot be written.
void write_mesh(const std::filesystem::path& path, const TetMesh& mesh);

// Throws InputError for an ending that write_mesh() would refuse. It is called before a mesh is made that could not be
// written.
void check_writable(const std::filesystem::path& path);

}  // namespace supple
