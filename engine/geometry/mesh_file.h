// Reads and writes MEDIT text files (.mesh), in which tetrahedral meshes come from outside. Everything that is read is
// checked; every refusal names the file and the line. Closed surfaces (surface_file.h) and scenes are read elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace supple {

struct MeshFile {
  TetMesh mesh;
  // Holds remarks on what was changed or is unusual, such as a flipped orientation or vertices that no element uses.
  std::vector<std::string> notes;
};

// Reads a tetrahedral mesh; its region tags are the file's element references. Throws InputError when the file is not a
// mesh, announces more rows than it holds, or has indices out of range, numbers that are not finite, elements without
// volume, elements listed twice, or elements of both orientations.
MeshFile read_mesh(const std::filesystem::path& path);

// Reads the Triangles of a file, for cloth, and ignores its elements. Vertices that no triangle uses are left out.
// Throws InputError as above, and for triangles without area or listed twice.
TriMesh read_surface(const std::filesystem::path& path);

// Writes seventeen significant digits, so that reading gives the same doubles back. Throws RunError when the file
// cannot be written.
void write_mesh(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace supple
