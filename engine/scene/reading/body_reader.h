// Reads the bodies of a scene file: what they are made of, where they start, and what holds them.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

Ease read_ease(const ConfigTable& table);

// Reads the list `keys`, in the order of time. `turn`: the meaning of the key turn_deg, for the documentation.
std::vector<MotionKey> read_keys(const ConfigTable& table, const char* turn);

// Reads the table of a body. defaults: the defaults of the body's solver, from the scene's table.
BodyDef read_body(const ConfigTable& table, const SolverDef& defaults);

}  // namespace supple
