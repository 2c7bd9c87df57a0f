// Writes traces as chrome://tracing and Perfetto read them: one track for each thread, zones as complete events ("X")
// in microseconds since the first one, and the threads' names as metadata ("M").
#pragma once

#include <string>
#include <vector>

#include "base/trace.h"

namespace supple {

// Returns JSON, one event a line. The number of a zone becomes the argument "frame", its subject becomes "body"; zones
// that were dropped for lack of room are counted in otherData.lost_zones.
std::string chrome_trace(const std::vector<ThreadTrace>& threads);

}  // namespace supple
