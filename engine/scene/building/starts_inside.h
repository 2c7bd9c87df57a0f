// Finds the bodies that start inside colliders, and decides what is done about each. Their warning is `inside`; the
// warning `overlap` is about bodies in the same place as others, or in themselves (body_passings.h, body_depths.h). Not
// here: how a body that stays inside is pushed out while the film runs (sim/contact/way_out.h).
#pragma once

#include "scene/building/body.h"

namespace supple {

struct SceneDef;

constexpr double tolerated_overlap = 1e-4;  // depth at the start that does not count, over the (smaller) body's size

// Sets Body::starts_inside, and Body::start_move where the scene wants the body moved and a small move is enough. Adds
// a problem for each collider in which the scene refuses a start.
void find_starts_inside(const SceneDef& scene, std::vector<Body>& bodies, std::vector<Problem>& problems);

// Tells in which colliders a body starts, and what is done about that; empty where it starts in none.
std::string start_inside_text(const Body& body);

}  // namespace supple
