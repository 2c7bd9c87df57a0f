// Checks a surface file before assimp reads it: numbers, counts, indices, and what is left at the end. assimp itself
// takes what it does not understand for something else. A part of supple-read-surface.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/types.h"

namespace supple {

// These characters stand in the bytes for assimp: one for a space in an object's name, and one between the names of an
// object and of a group in it.
inline constexpr char space_in_name = '\x1e', end_of_name = '\x1f';

struct CheckedSurface {
  std::string bytes;  // assimp reads these in the file's place; empty: it reads the file
  // The place that is taken off all positions in `bytes`, so that floats keep the shape of a body that is far from the
  // origin [file's units].
  Vec3 origin = Vec3::Zero();
  std::vector<std::string> remarks;
};

// Reads and checks a file: OBJ, OFF, PLY, STL and glTF in all that decides their shape, COLLADA in its lists of
// numbers, AC3D, ASE, NFF, RAW and SMD for decimal commas; of other formats, only that it is a plain file. Throws
// InputError with line and column, or with the accessor, where the file is no good.
CheckedSurface checked_surface(const std::filesystem::path& file);

// These check one format each. bytes: the content of the file without a byte-order mark.
CheckedSurface checked_obj(std::string bytes, const std::string& name);
CheckedSurface checked_off(std::string bytes, const std::string& name);
CheckedSurface checked_ply(std::string bytes, const std::string& name);
CheckedSurface checked_stl(std::string bytes, const std::string& name);
CheckedSurface checked_collada(std::string bytes, const std::string& name);
CheckedSurface checked_gltf(std::string bytes, const std::filesystem::path& file);

// Returns the place that is taken off positions within the box: zero where floats keep enough digits as it is.
Vec3 far_origin(const Bounds& box);

}  // namespace supple
