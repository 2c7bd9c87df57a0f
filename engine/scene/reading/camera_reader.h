// Reads the table [camera] of a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Records problems in the table's Config: keys that contradict each other, and a motion out of order.
CameraDef read_camera(const ConfigTable& table, CameraDef camera);

}  // namespace supple
