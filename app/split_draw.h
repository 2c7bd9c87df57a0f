// Draws several runs into one film, side by side: supple draw RUN RUN ... --layout row.
#pragma once

#include <string>
#include <vector>

#include "film/redraw/redraw.h"
#include "film/redraw/split_screen.h"
#include "output/video/video.h"

namespace supple {

struct SplitCommand {
  DrawPlan plan;  // the plan for each run, without the run's folder
  std::vector<std::string> runs;
  std::filesystem::path folder;
  Layout layout = Layout::row;
  FilmCoding coding;
  bool quiet = false;
};

// Draws each run into a folder of its own below `folder`, and from these pictures the film. Returns the exit status.
int draw_split(const SplitCommand& command);

}  // namespace supple
