// Reads closed triangle surfaces from outside: OBJ, PLY, STL, glTF, OFF and any other format that assimp reads. A
// broken file can end the process that reads it, so assimp runs in a program of its own, supple-read-surface, under
// limits. MEDIT files are read by mesh_file.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/files/colored_surface.h"
#include "geometry/solids/solid_surface.h"

namespace supple {

// Reads the triangles and colours of a file as they are there. Node transforms are applied; polygons are cut into
// triangles; points and lines are left out; textures inside the file or beside it are read. Throws InputError as
// read_closed_surface() does, except that the surface need not be closed.
ColoredSurface read_colored_surface(const std::filesystem::path& path);

// Reads a file and returns its closed surface, without its colours. Remarks are added to `notes`, as by closed_surface
// (geometry/solids/closed_surface.h).
// Throws InputError when the file does not exist, has no triangles or is too large, when its reader crashed, took too
// long or refused it, and when the surface is not closed.
TriMesh read_closed_surface(const std::filesystem::path& path, std::vector<std::string>* notes);

// Reads a surface that need not be closed; solid_surface() makes a solid of it as the options say. Throws InputError as
// above, and as solid_surface() does.
SolidSurface read_solid_surface(const std::filesystem::path& path, const SurfaceOptions& options,
                                std::vector<std::string>* notes);

// Reads a picture (PNG, JPEG, TGA, BMP) as textures are read, with rows from the top; its transparency is not kept.
// Throws InputError when there is no such file, and when it is damaged, too large or no such picture.
Texture read_picture(const std::filesystem::path& path);

// Returns where the reading program is: beside the running program, where an installation puts it, or where the build
// put it (for programs in other folders).
std::filesystem::path surface_reader_program();

}  // namespace supple
