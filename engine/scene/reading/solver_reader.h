// Reads the `solver` table of a scene file, for the whole scene or for a body.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Reads the table. Keys that are absent keep their defaults.
SolverDef read_solver(const ConfigTable& table, const SolverDef& defaults);

}  // namespace supple
