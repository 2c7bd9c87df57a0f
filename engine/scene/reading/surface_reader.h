// Reads how a surface from a file is taken: its axes and units, and what is done where it is not closed.
#pragma once

#include "geometry/solids/solid_surface.h"
#include "scene/config/config.h"

namespace supple {

// Reads the keys that bodies and parts of shapes have in common. They are refused in tables without a `surface`.
SurfaceOptions read_surface_options(const ConfigTable& table);

}  // namespace supple
