// Writes surfaces as Wavefront OBJ, on which other programs put a body's motion. All vertices of the mesh are written
// in its order, including those inside, so that a point cache of the same mesh fits them one by one.
#pragma once

#include <filesystem>

#include "base/types.h"

namespace supple {

// Writes nine significant digits, as many as point caches hold. The file is either whole or not there. Throws RunError
// when the disk refuses.
void write_obj(const std::filesystem::path& path, const Positions& points, const Triangles& triangles);

}  // namespace supple
