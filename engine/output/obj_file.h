// Surfaces as Wavefront OBJ: what other programs put a body's motion on. Vertices stand in the order of the mesh, those
// inside it too, so that a point cache of the same mesh fits them one by one.
#pragma once

#include <filesystem>

#include "base/types.h"

namespace supple {

// Nine significant digits, which is what point caches hold. Whole or not there. Throws RunError when the disk refuses.
void write_obj(const std::filesystem::path& path, const Positions& points, const Triangles& triangles);

}  // namespace supple
