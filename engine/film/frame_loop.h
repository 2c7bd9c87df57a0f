// Defines the loop that makes a film. Each frame of the world is entered, stepped, recorded, listed to be drawn, and
// logged; the threads of Pictures draw and compress meanwhile. Nothing that these threads do can change a result.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/pictures/drawn_film.h"
#include "film/pictures/pictures.h"
#include "film/progress.h"
#include "film/record/body_recorder.h"
#include "film/record/film_log.h"
#include "film/record/pair_recorder.h"
#include "output/motion/pose_table.h"

namespace supple {

// Represents a film in progress.
class FrameLoop {
 public:
  // All that is passed must outlive this object. video: null when no video is made.
  FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
            const FilmSolvers& solvers, FilmLog& log, VideoEncoder* video);

  // Makes the frames that remain. Returns how the film ended; when a step failed, `message` says why. When pictures
  // failed, finish() reports why.
  FilmEnd run(Progress& progress, std::string& message);

  // Waits for the pictures and writes a checkpoint after the last frame.
  void finish(FilmResult& result);

 private:
  // These functions are the parts of a frame, in their order.
  void enter(int frame, FrameRow& row);
  std::string step(int frame, FrameRow& row);
  void record(int frame, FrameRow& row);
  bool show(int frame, FrameRow& row);

  std::string compare_with_record(int frame);
  void save_outputs(int frame, const FrameRow& row);
  void keep_motion();
  void resume(const WorldState& checkpoint);
  void keep_checkpoint_before();
  void add_checkpoint();
  // Returns the frames whose pictures have been written since the last call.
  std::vector<PictureTimes> written_pictures() {
    return pictures_ ? pictures_->take_written() : std::vector<PictureTimes>();
  }

  const FilmPlan& plan_;
  World& world_;
  const RunFolder& folder_;
  Threads threads_;
  int first_;  // the first frame that this run makes; those before it are an earlier run's
  FilmLog& log_;
  bool graphs_;                         // whether the pictures have graphs
  std::vector<GraphPoint> graphed_;     // points of the frames so far, where the pictures have graphs
  StateVerifier* verifier_;             // compares states for --verify; null without it
  WorldState checkpoint_before_;        // taken before the frame in progress; empty when the film keeps none
  std::optional<DrawnFilm> drawn_;      // only with pictures
  std::vector<Positions> last_motion_;  // of the bodies at the end of the last frame, where the pictures need it [m]
  WorldErrors errors_;                  // measures steps where the plan asks for it
  std::vector<std::unique_ptr<BodyRecorder>> recorders_;  // of each body
  PairRecorder pairs_;                                    // notes the pairs of bodies that touch
  std::optional<PoseTableWriter> poses_;                  // only with colliders
  std::optional<StateRecorder> states_;                   // for --record
  std::optional<Pictures> pictures_;                      // last, so that its threads end first
};

}  // namespace supple
