// Bodies of a scene file: what they are, how they are held, how they are solved.
#pragma once

#include "scene/config.h"
#include "scene/scene_def.h"

namespace supple {

// Keys that are absent keep their defaults.
SolverDef read_solver(const ConfigTable& table, const SolverDef& defaults);

Ease read_ease(const ConfigTable& table);

// The list `keys`, in order of time; `turn` says what its rotations are about.
std::vector<MotionKey> read_keys(const ConfigTable& table, const char* turn);

BodyDef read_body(const ConfigTable& table, const SolverDef& defaults);

}  // namespace supple
