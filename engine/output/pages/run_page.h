// Makes one HTML page of a run: the film, what was run, the times, errors and contacts of its frames with a cursor that
// goes along with the film, its slowest frames and its warnings. The page needs no other file and loads nothing.
#pragma once

#include <string>

#include "output/run/run_record.h"

namespace supple {

// Returns the page as HTML. The film and the last picture are read from the run's folder where they are there. Without
// profile.json the page tells only what was run.
std::string run_page(const RunRecord& run);

}  // namespace supple
