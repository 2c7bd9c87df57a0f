// Reads the table `start` of a body in a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/start_state.h"

namespace supple {

// Reads how a body starts: at rest when it has no such table.
StartDef read_start(const ConfigTable& body);

}  // namespace supple
