// Tells before a film is made which bodies its pictures will not show: by a rough first pass, with meshes as coarse as
// can be, few iterations, and no more steps than take about a second for solids.
#pragma once

#include "film/plan/film_plan.h"
#include "film/plan/film_solvers.h"

namespace supple {

// Returns a warning for each body that pictures of the first pass do not show, or cut at their border, in the words of
// RowTally::missing_in_pictures(). A replay is followed to its first change. Where not even one frame can be made in
// about a second, the bodies are looked at where they start. Throws InputError.
std::vector<std::string> missing_in_rough_pictures(const FilmPlan& plan, const FilmSolvers& solvers);

}  // namespace supple
