// Finds the vertices that pictures mark: those that handles hold, and those that touch colliders.
#pragma once

#include <array>
#include <vector>

#include "base/threads.h"
#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"

namespace supple {

// Returns how deep each vertex lies in colliders and the layers around them, by the collider in which it is deepest
// [m]. Depths of vertices outside are negative, and only exact above -reach; they are -reach where no collider is as
// near.
std::vector<double> depths_in(const Positions& x, const CollisionSet& set, double time, double reach, Threads* threads);

// Appends x y z [m] and 0 for each vertex that a handle holds at the time [s], 1 for each that lies within a thousandth
// of the body's size of a collider. motion: the positions of the body's mesh, n x 3 [m].
void append_marks(const Body& body, const Positions& motion, const CollisionSet& set, double time, Threads* threads,
                  std::vector<std::array<float, 4>>& marks);

}  // namespace supple
