// Reads the table [camera] of a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Reads the table. Records problems in its Config: keys that contradict each other, and keys of a motion that are not
// in order of time.
CameraDef read_camera(const ConfigTable& table, CameraDef camera);

}  // namespace supple
