// Closed triangle surfaces from outside: OBJ, PLY, STL, glTF, OFF and whatever else assimp reads. A broken file can end
// the process that reads it, so assimp runs in a program of its own, supple-read-surface, under limits. Not here: MEDIT
// files (mesh_file.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace supple {

// Node transforms are applied; polygons are cut into triangles; points, lines and materials are left out. Adds to
// `notes` what closed_surface does. Throws InputError: no file, nothing in it, too large; crashed, took too long or was
// refused while it was read; no closed surface.
TriMesh read_closed_surface(const std::filesystem::path& path, std::vector<std::string>* notes);

// The same triangles as the boundary of a solid: equal positions are one vertex; triangles without area or listed twice
// are left out; all face outward, and those of a cavity into it. A component that lies wholly in another is a cavity if
// it is turned the other way. Holes of together up to 2 % of a component's area are tolerated. All that is changed or
// odd is added to `notes`. Throws InputError, with the number of a triangle of `raw` from 1 and its place: open
// surfaces, edges with three triangles and more, one-sided surfaces, numbers that are not finite, indices out of range.
TriMesh closed_surface(TriMesh raw, const std::string& name, std::vector<std::string>* notes);

// Where the reading program is looked for: beside the one that runs, where an installation puts it, or where the build
// did (for programs in other folders).
std::filesystem::path surface_reader_program();

}  // namespace supple
