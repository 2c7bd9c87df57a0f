// Reads how the vertices of a surface move, frame by frame: PC2 and MDD point caches, series of OBJ files, and the
// folder of a run. Positions have the axes and units of their file. Not here: what surface they move
// (shapes/solid_motion.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/files/source_file.h"

namespace supple {

struct VertexMotion {
  std::vector<Positions> frames;  // vertices x 3 each, in the order of the surface's file
  std::filesystem::path file;     // the file that was read; of a series the first one
};

// Says what a motion may be, for messages.
inline constexpr const char* motion_kinds =
    "a .pc2 or .mdd point cache, a series of OBJ files such as 'walk_*.obj', or the folder of a run";

// Tells whether a path is there: a file, a folder, or for a path with a '*' in its last name at least one file of the
// series.
bool is_motion_there(const std::filesystem::path& path);

// Reads a motion. body: the body whose motion is read, where the path is the folder of a run. Throws InputError that
// names the file where it cannot be read, is cut short, is no such file, or has numbers that are not finite.
VertexMotion read_vertex_motion(const std::filesystem::path& path, const std::string& body);

// Returns the vertices of an OBJ file in its order, also those that no triangle has.
Positions read_obj_vertices(const std::filesystem::path& path);

// Returns the file of a motion with the hash of all its positions.
SourceFile source_of(const VertexMotion& motion);

}  // namespace supple
