// MEDIT text files (.mesh): the tetrahedral meshes that come from outside. Everything read is checked; everything
// refused names file and line. Not here: surfaces and scenes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace supple {

struct MeshFile {
  TetMesh mesh;
  std::vector<std::string>
      notes;  // what was changed or is odd, in words: orientation turned, vertices that nobody uses
};

// Region tags are the file's element references. Throws InputError: not a mesh, counts that the file does not hold,
// indices out of range, numbers that are not finite, elements without volume or listed twice, elements of both
// orientations.
MeshFile read_mesh(const std::filesystem::path& path);

// The Triangles of a file, for cloth; its elements are not looked at. Vertices that no triangle uses are left out.
// Throws InputError: as above, triangles without area or listed twice.
TriMesh read_surface(const std::filesystem::path& path);

// Seventeen significant digits, so that reading gives the same doubles back. Throws RunError when the disk does.
void write_mesh(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace supple
