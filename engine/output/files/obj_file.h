// Writes surfaces as Wavefront OBJ, on which other programs put a body's motion. All vertices of the mesh are written
// in its order, including those inside, so that a point cache of the same mesh fits them one by one.
#pragma once

#include <filesystem>
#include <string>

#include "base/types.h"

namespace supple {

// Returns the place relative to which a body's surface and motion are written [m]: zero, except far from the world's
// origin, where single precision would lose the shape (at 2e5 m it has steps of 1.6 cm). Its coordinates are multiples
// of a power of two that is at least the body's size, so that nothing is rounded.
Vec3 motion_origin(const Positions& rest);

// Writes points less `origin` with nine significant digits, as many as point caches hold; a comment in the first line
// tells the origin where it is not zero. The file is either whole or not there. Throws RunError when the disk refuses.
void write_obj(const std::filesystem::path& path, const Positions& points, const Triangles& triangles,
               const Vec3& origin = Vec3::Zero());

// Returns the line with which a file begins where the origin is not zero; empty where it is zero.
std::string origin_line_of_obj(const Vec3& origin);
// Returns the origin that a file's first line tells; zero where it tells none [m].
Vec3 origin_of_obj(const std::filesystem::path& path);

}  // namespace supple
