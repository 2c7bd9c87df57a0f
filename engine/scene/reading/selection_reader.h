// Reads which vertices of a body a handle takes. The vertices are found in scene/building/selected_vertices.h.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/selection.h"

namespace supple {

// Returns the selection of a handle's table. Problems are recorded in its Config.
Selection read_selection(const ConfigTable& handle);

}  // namespace supple
