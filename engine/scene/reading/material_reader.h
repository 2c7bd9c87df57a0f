// Reads materials in the forms that scene files have: a preset's name, or a table with the model and its parameters.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Reads `material` (and `fibre`) of a body or a region.
SubstanceDef read_substance(const ConfigTable& owner);

// Returns the table that a preset stands for, { model = "neo-hookean", young = ..., poisson = ... }, and the other
// values that it sets. Empty when no preset has this name.
std::string preset_in_full(const std::string& name);

}  // namespace supple
