// Identifies a file of a scene by what was read from it: neither comments in the file nor its location change the
// identity.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"
#include "geometry/solids/solid_surface.h"

namespace supple {

struct SourceFile {
  std::filesystem::path path;
  std::uint64_t hash = 0;  // XXH64 of the content that was read
};

// The mesh must be as it was read: not yet rotated, scaled, renamed or renumbered.
SourceFile source_of(const std::filesystem::path& path, const TetMesh& mesh);
SourceFile source_of(const std::filesystem::path& path, const TriMesh& mesh);
// A surface is known by its boundary, and by what is drawn of it where that is something else.
SourceFile source_of(const std::filesystem::path& path, const SolidSurface& surface);

// Returns a name for the content of files, which does not depend on where they are.
std::string content_name(const std::vector<SourceFile>& files);

}  // namespace supple
