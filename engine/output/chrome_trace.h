// Traces as chrome://tracing and Perfetto read them: one track a thread, zones as complete events ("X") in microseconds
// since the first, threads' names as metadata ("M").
#pragma once

#include <string>
#include <vector>

#include "base/trace.h"

namespace supple {

// JSON, an event a line. The number of a zone becomes the argument "frame", its subject "body"; zones that found no
// room are counted in otherData.lost_zones.
std::string chrome_trace(const std::vector<ThreadTrace>& threads);

}  // namespace supple
