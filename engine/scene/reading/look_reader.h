// Reads what is seen beside the bodies and the camera: the tables [look], [field] and [text] of a scene file.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

LookDef read_look(const ConfigTable& root, LookDef look);
FieldDef read_field(const ConfigTable& root);
TextDef read_text(const ConfigTable& root);

}  // namespace supple
