// Makes bodies that are ready to run from their definitions: meshes are read or made, placed and scaled, and the
// vertices of handles are found. What is drawn of bodies is made in drawn_body.h.
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

// Adds a handle to a body. def: its definition, which must be the one in body.def.handles that follows those of the
// handles that the body has. Where two handles would hold a vertex at the same time, the first one has it. Adds a
// problem where the handle has no vertex, names one that the mesh does not have, or leaves the body no free one.
void add_handle(Body& body, const HandleDef& def, std::vector<Problem>& problems);

// Returns the positions in which a body starts, by vertex of its mesh [m].
Positions first_positions(const Body& body);
// Returns the positions of a body when the clock is at 0, by vertex of its mesh [m]. In a film that goes on from
// another run, that is before the film begins.
Positions scene_start(const Body& body);
// Returns the state in which a body starts: that of an earlier run, or else its first positions, with its velocity and
// spin, but without velocity at vertices of handles that do not grab.
State start_state(const Model& model, const Body& body);

// Makes a handle grab its vertices at their present positions, from which its keys then move them.
void grab(const Model& model, int handle, const Positions& x, Anchors& anchors);

// Computes the targets of all handled vertices, in the order of model.handled. change: the share that is done of a
// change which is spread over the frame, 0 to 1.
void handle_targets(const Model& model, const Body& body, const Anchors& anchors, double time, double change,
                    Positions& targets);
// Does the same for a body whose handles grab nothing and whose definition does not change.
void handle_targets(const Model& model, const Body& body, double time, Positions& targets);

}  // namespace supple
