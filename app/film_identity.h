// By what a film is known again: what a checkpoint belongs to, and what a record of its states was made of.
#pragma once

#include "app/film_run.h"

namespace supple {

// XXH64 of the points, elements and springs of a body.
std::string mesh_hash(const Body& body);

// All that must be the same for two runs to give the same films and fields, but for their length: as JSON.
std::string identity_of(const RunInfo& info, const Script& script, const std::vector<Body>& bodies,
                        const FilmRequest& request);

RecordHead record_head(const RunInfo& info, const std::vector<Body>& bodies);

}  // namespace supple
