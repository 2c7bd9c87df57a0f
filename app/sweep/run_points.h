// Runs all points of a sweep on this machine, several at a time, each in a process of its own.
#pragma once

#include "app/sweep/point.h"

namespace supple {

// Runs the points that are not done (with `again`, all of them), `jobs` at a time (0: as many as there are cores for),
// and then merges. Returns the exit status: 1 when a point failed, 130 when interrupted.
int run_points(const SweepRequest& request, int jobs, bool again);

}  // namespace supple
