// Two parts that begin a step deep in each other leave each other on one way. Each point would otherwise leave by the
// place that is closest to it, to all sides, and the parts would stay in each other, torn.
#pragma once

#include "sim/contact/surface_work.h"

namespace supple {

// Finds the way of the two parts of a meeting, if it is not known yet, for this meeting and for the one in which their
// places are exchanged. The surface that the meeting is about must be a solid's.
void find_common_way(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                     const Positions& y, const Positions& x, SurfaceWork::Parts& work);

}  // namespace supple
