// The loop that makes a film: it makes the steps of a frame and hands what is to be drawn to Pictures, whose threads
// draw and compress meanwhile. Nothing that they do can change a result.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "film/drawn_film.h"
#include "film/film.h"
#include "film/film_log.h"
#include "film/pictures.h"
#include "film/progress.h"
#include "output/pose_table.h"

namespace supple {

// A film in progress.
class FrameLoop {
 public:
  // All that is passed must outlive this object. video: null where there shall be none.
  FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
            const FilmSolvers& solvers, FilmLog& log, VideoEncoder* video);

  // Makes the frames that are left. Returns how it ended; `message` says why it failed.
  FilmEnd run(Progress& progress, std::string& message);

  // Waits for the pictures, and leaves a checkpoint after the last frame.
  void finish(FilmResult& result);

 private:
  // Parts of a frame, in their order.
  void apply_replay(int frame, FrameRow& row);
  std::string advance(int frame, FrameRow& row);
  void save_outputs(int frame, const FrameRow& row);
  bool show(int frame, FrameRow& row);

  void resume(const Checkpoint& checkpoint);
  void forget_earlier();
  void apply(SceneDef scene, const std::vector<TimedChange>& changes);
  void renew_changed_surfaces(const std::vector<TimedChange>& changes);
  std::string advance_body(int frame, FilmedBody& body, FrameRow& row);
  Checkpoint checkpoint_after(int frames) const;
  void keep_state_before(int frame);  // the state before it, in case that the frame fails
  void add_checkpoint(int frames);
  Pictures* pictures() { return pictures_ ? &*pictures_ : nullptr; }

  const FilmPlan& plan_;
  const Script& script_;
  std::vector<Body>& bodies_;
  const RunFolder& folder_;
  SceneDef scene_;  // of the frame in progress
  CollisionSet set_;
  Threads threads_;
  int first_;  // frame that is made
  FilmLog& log_;
  StateVerifier* verifier_;         // null: there is nothing to compare with
  Checkpoint before_;               // the frame in progress, in case that it fails
  std::optional<DrawnFilm> drawn_;  // only with pictures
  std::vector<std::unique_ptr<FilmedBody>> filmed_;
  std::optional<PoseTableWriter> poses_;  // only with colliders
  std::optional<StateRecorder> recorder_;
  std::optional<Pictures> pictures_;  // last, so that its threads end first
};

}  // namespace supple
