// Reads the colliders of a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

ColliderDef read_collider(const ConfigTable& table);

}  // namespace supple
