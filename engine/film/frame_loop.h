// Defines the loop that makes a film: it makes the steps of a frame and hands what is to be drawn to Pictures, whose
// threads draw and compress meanwhile. Nothing that they do can change a result.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/pictures/drawn_film.h"
#include "film/pictures/pictures.h"
#include "film/progress.h"
#include "film/record/film_log.h"
#include "film/record/filmed_body.h"
#include "output/motion/pose_table.h"
#include "scene/building/body_meetings.h"

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
  void apply_replay(int frame, FrameRow& row);
  std::string step_bodies(int frame, FrameRow& row);
  void find_meetings(FrameRow& row);
  void save_outputs(int frame, const FrameRow& row);
  bool show(int frame, FrameRow& row);
  void keep_motion();

  void resume(const Checkpoint& checkpoint);
  void end_last_changes();
  void apply(SceneDef scene, const std::vector<TimedChange>& changes);
  void look_for_meetings();
  std::string step_body(int frame, FilmedBody& body, FrameRow& row);
  Checkpoint checkpoint_after(int frames) const;
  void keep_checkpoint_before(int frame);
  void add_checkpoint(int frames);
  // Returns the frames whose pictures have been written since the last call.
  std::vector<PictureTimes> written_pictures() {
    return pictures_ ? pictures_->take_written() : std::vector<PictureTimes>();
  }

  const FilmPlan& plan_;
  const Script& script_;
  std::vector<Body>& bodies_;
  const RunFolder& folder_;
  SceneDef scene_;          // of the frame in progress
  CollisionSet colliders_;  // the colliders of the frame in progress
  Threads threads_;
  int first_;  // the first frame that this run makes; those before it are an earlier run's
  FilmLog& log_;
  bool graphs_;                         // whether the pictures have graphs
  std::vector<GraphPoint> graphed_;     // of the frames so far, where the pictures have graphs
  StateVerifier* verifier_;             // compares states for --verify; null without it
  Checkpoint checkpoint_before_;        // taken before the frame in progress; empty when the film keeps none
  std::optional<DrawnFilm> drawn_;      // only with pictures
  std::vector<Positions> last_motion_;  // of the bodies at the end of the last frame, where the pictures need it [m]
  std::vector<std::unique_ptr<FilmedBody>> filmed_;
  BodyMeetings meetings_;                 // that no earlier frame has had
  std::optional<PoseTableWriter> poses_;  // only with colliders
  std::optional<StateRecorder> recorder_;
  std::optional<Pictures> pictures_;  // last, so that its threads end first
};

}  // namespace supple
