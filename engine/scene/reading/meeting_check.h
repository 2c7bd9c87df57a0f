// Checks what the bodies of a scene say of each other, once all of them have been read.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Refuses names in `contact.meets` that are not those of other bodies, and pairs that cannot meet although one of the
// bodies names the other. Problems are recorded in the config.
void check_meetings(const SceneDef& scene, Config& config);

}  // namespace supple
