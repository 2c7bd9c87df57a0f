// Bodies of a scene file: what they are, how they are held, how they are solved.
#pragma once

#include "scene/config.h"
#include "scene/scene_def.h"

namespace supple {

// Keys that are absent keep their defaults.
SolverDef read_solver(const ConfigTable& table, const SolverDef& defaults);

BodyDef read_body(const ConfigTable& table, const SolverDef& defaults);

}  // namespace supple
