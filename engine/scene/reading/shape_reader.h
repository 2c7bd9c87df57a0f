// Reads shapes from TOML tables: see docs/scene-format.md, "Shapes".
#pragma once

#include "geometry/shapes/shape.h"
#include "geometry/solids/solid_surface.h"
#include "scene/config/config.h"

namespace supple {

// Reads a shape file's root table (lists `part` and `paint`). Problems are recorded in the table's Config.
Shape read_shape(const ConfigTable& table);

// Reads a table that is one part, such as { sphere = { radius = 1 } }.
Shape read_single_part(const ConfigTable& table);

// Loads and reads a shape file. Throws InputError with all problems. Closed surfaces that `user` has read already are
// not read again.
Shape load_shape(const std::filesystem::path& path, const std::filesystem::path& assets, Config* user = nullptr);

}  // namespace supple
