// Finds one way on which two parts that begin a step deep in each other leave each other. If each point left by the
// place that is closest to it, the points would go to all sides, and the parts would stay in each other, torn.
#pragma once

#include "sim/contact/surface_work.h"

namespace supple {

// Writes the way of the two parts of a meeting to work.common_ways, if it is not known yet: for this meeting, and for
// the one in which points and surface are exchanged. The surface that the meeting is about must be a solid's.
void find_common_way(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                     const Positions& y, const Positions& x, SurfaceWork::Parts& work);

}  // namespace supple
