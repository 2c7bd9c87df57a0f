// Finds what an earlier run was made from, for those who draw it again or go on from it.
#pragma once

#include "film/plan/loaded_film.h"
#include "output/run/run_record.h"

namespace supple {

// Returns the plan of a run's film. scene: the scene's file, where it is not where the run found it; else empty.
// settings: path=value, after those of the run. Throws InputError when the run does not tell its scene, or the scene is
// no longer there.
FilmPlan plan_of_run(const RunRecord& run, const std::filesystem::path& scene,
                     const std::vector<std::string>& settings);

// Returns the time at the end of a run's frame, as the run's own clock tells it [s]; of frame -1, when the clock
// starts.
double time_in_run(const RunRecord& run, int frame);

// Refuses a film that would move in another way than the run did: one whose values differ in more than what is seen, or
// that has other changes or other meshes. Throws InputError with all differences.
void check_same_motion(const RunRecord& run, const LoadedFilm& film);

}  // namespace supple
