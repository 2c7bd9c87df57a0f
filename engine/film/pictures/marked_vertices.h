// Finds the vertices that pictures mark: those that handles hold, and those that touch colliders.
#pragma once

#include <array>
#include <vector>

#include "base/threads.h"
#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"

namespace supple {

// Returns how deep each vertex lies in the layer around the colliders, the deepest of all of them; negative for
// vertices outside, where only values above -reach are exact [m]. Without colliders all are -reach.
std::vector<double> depths_in(const Positions& x, const CollisionSet& set, double time, double reach, Threads* threads);

// Appends x y z [m] and 0 for each vertex that a handle holds at the time [s], 1 for each that lies within a thousandth
// of the body's size of a collider. motion: the positions of the body's mesh, n x 3 [m].
void append_marks(const Body& body, const Positions& motion, const CollisionSet& set, double time, Threads* threads,
                  std::vector<std::array<float, 4>>& marks);

}  // namespace supple
