// Guides the loop over frames (frame_loop.h) through a film, from the frame with which this run begins to the last one.
// Notes rows, written pictures and checkpoints in the run's log, and shows a line of progress.
#pragma once

#include <optional>

#include "film/frame_loop.h"
#include "film/progress.h"
#include "film/record/film_log.h"

namespace supple {

class FilmGuide : public FrameGuide {
 public:
  // All that is passed must outlive this object. pictures: null where nothing is drawn.
  FilmGuide(const World& world, FilmLog& log, Pictures* pictures, Progress& progress)
      : world_(world), log_(log), pictures_(pictures), progress_(progress), first_(world.frames()) {}

  std::optional<FilmEnd> ends() override;
  void begin() override;
  void take(FrameRow row) override;

  // Waits for the pictures and writes a checkpoint after the last frame. When pictures failed, the result says why.
  void finish(FilmResult& result);

 private:
  void add_checkpoint();
  void settle();

  const World& world_;
  FilmLog& log_;
  Pictures* pictures_;
  Progress& progress_;
  int first_;                     // the first frame that this run makes; those before it are an earlier run's
  WorldState checkpoint_before_;  // taken before the frame in progress; empty when the film keeps none
};

}  // namespace supple
