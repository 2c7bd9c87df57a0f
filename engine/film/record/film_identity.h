// Defines how a film is recognised: by the identity to which a checkpoint belongs, and by the head of a record of its
// states.
#pragma once

#include "film/plan/film_plan.h"
#include "film/record/state_record.h"
#include "output/run/run_folder.h"
#include "scene/building/assemble.h"
#include "scene/replay/script.h"

namespace supple {

// Returns, as JSON, all that must be the same for two runs to give the same films and fields, except for their length.
std::string identity_of(const RunInfo& info, const Script& script, const std::vector<Body>& bodies,
                        const FilmPlan& plan);

// Returns the head of a record of this film's states.
RecordHead record_head(const RunInfo& info, const std::vector<Body>& bodies);

}  // namespace supple
