// Makes ready-to-run objects from definitions: meshes are read or made, placed and scaled, and handles are chosen. What
// is drawn of them is made in drawn_body.h.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "scene/building/body.h"
#include "sim/model/state.h"

namespace supple {

struct SceneDef;
struct SlowWork;  // base/slow_work.h

// Makes all bodies of a scene. Throws InputError with the problems of all bodies at once: meshes that cannot be read,
// empty selections, regions that the mesh does not have.
std::vector<Body> assemble(const SceneDef& scene);
// Does the same, keeps meshes from run to run, and tells what takes long.
std::vector<Body> assemble(const SceneDef& scene, const SlowWork& work);

// Updates the values that may change while a body moves (live_keys.h) to those of the scene's present definition.
// Throws InputError.
void update_body(Body& body, const SceneDef& scene, const BodyDef& def);

// Adds a handle to a body, whose definition has it next behind those that the body has already. Where two handles would
// hold a vertex at the same time, the first one has it. Adds to the problems where no vertex is left, or none free.
void add_handle(Body& body, const HandleDef& def, std::vector<Problem>& problems);

// Returns the positions in which a body starts, by vertex of its mesh [m].
Positions first_positions(const Body& body);
// Returns those in which it is when the clock is at 0, which is earlier where the film goes on from another run.
Positions scene_start(const Body& body);
// Returns the state in which a body starts: handled vertices are at rest, and handles move them from there.
State start_state(const Model& model, const Body& body);

// Makes a handle grab its vertices at their present positions, from which its keys then move them.
void grab(const Model& model, int handle, const Positions& x, Anchors& anchors);

// Computes the targets of all handled vertices, in the order of model.handled. change: how much is done of a change
// that is spread over the frame, 0 to 1.
void handle_targets(const Model& model, const Body& body, const Anchors& anchors, double time, double change,
                    Positions& targets);
// Does the same for a body whose handles grab nothing and whose definition does not change.
void handle_targets(const Model& model, const Body& body, double time, Positions& targets);

}  // namespace supple
