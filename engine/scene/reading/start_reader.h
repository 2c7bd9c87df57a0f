// Reads the table `start` of a body in a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/start_state.h"

namespace supple {

// Returns a start at rest when the body has no such table.
StartDef read_start(const ConfigTable& body);

}  // namespace supple
