// Reads the colliders of a scene file.
#pragma once

#include "scene/config.h"
#include "scene/scene_def.h"

namespace supple {

ColliderDef read_collider(const ConfigTable& table);

}  // namespace supple
