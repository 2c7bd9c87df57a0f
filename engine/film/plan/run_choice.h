// Chooses the folder of a run, so that no run overwrites another one: where the folder that is asked for holds the
// results of another film, the run goes to the next free one of NAME-2, NAME-3, ... A run of the same film takes the
// folder over, because it leaves the same results there.
#pragma once

#include <filesystem>
#include <string>

#include "film/plan/film_plan.h"
#include "output/run/run_folder.h"

namespace supple {

struct RunPlace {
  std::filesystem::path path;
  std::string note;         // for people; empty where the folder is free
  bool is_as_asked = true;  // the folder is the one that was asked for
};

// Chooses among `asked` and its numbered neighbours. info: what run.json will say of this run. Changes nothing.
RunPlace place_of_run(const std::filesystem::path& asked, const FilmPlan& plan, const RunInfo& info);

}  // namespace supple
