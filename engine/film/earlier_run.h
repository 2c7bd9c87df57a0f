// Lets a film go on from where an earlier run was at the end of one of its frames (`from` of a scene).
#pragma once

#include <string>
#include <vector>

#include "film/plan/film_plan.h"
#include "world/solvers.h"
#include "world/world.h"

namespace supple {

// Lets the bodies of a film start as bodies of the same names were at the end of the run's frame: with their positions
// and velocities, the shapes that they keep, and what their handles held; bodies that are still the same also get what
// their solvers remember. The world must not have been started. The run's steps are made again, from its last
// checkpoint before that frame or from its start, because a run keeps no more than the positions of its frames, in
// single precision. Does nothing for a scene without `from`.
//
// Returns notes for people: what was made again, and which bodies only one of the two has. Throws InputError where
// there is no such run or frame, where the run's scene has changed since, and where a body cannot go on from there,
// because it has another mesh, flows in another way, or has a handle that would pull it back to its place at rest;
// RunError where a step fails, or the user interrupts.
std::vector<std::string> go_on_from_run(const FilmPlan& plan, const Solvers& solvers, World& world);

// Refuses a scene whose earlier run is not there, or lacks the frame. Makes no step. Throws InputError.
void check_earlier_run(const SceneDef& scene);

}  // namespace supple
