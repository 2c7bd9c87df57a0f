// A file that a scene is made of, known again by what was read of it: comments in it, or where it lies, change nothing.
#pragma once

#include <cstdint>
#include <filesystem>

#include "geometry/mesh.h"

namespace supple {

struct SourceFile {
  std::filesystem::path path;
  std::uint64_t hash = 0;  // XXH64 of what was read
};

// As read: before anything is turned, scaled, renamed or renumbered.
SourceFile source_of(const std::filesystem::path& path, const TetMesh& mesh);
SourceFile source_of(const std::filesystem::path& path, const TriMesh& mesh);

}  // namespace supple
