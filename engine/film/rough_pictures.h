// Tells what the pictures of a film will not show, before the film is made: by a rough first pass, with meshes as
// coarse as can be, few iterations, and no more steps than take about a second.
#pragma once

#include "film/plan/film_plan.h"
#include "film/plan/film_solvers.h"

namespace supple {

// Returns a warning for each body that pictures of the first pass do not show, or cut at their border, in the words of
// RowTally::missing_in_pictures(). A replay is followed to its first change. Where not even a frame can be made in that
// time, the bodies are looked at where they start. Throws InputError.
std::vector<std::string> missing_in_rough_pictures(const FilmPlan& plan, const FilmSolvers& solvers);

}  // namespace supple
