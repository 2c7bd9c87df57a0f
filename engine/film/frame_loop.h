// Defines the loop that makes the frames of a world, one after the other. Each frame is entered, stepped, recorded,
// and listed to be drawn; the threads of the pictures draw and compress meanwhile. Nothing that these threads do can
// change a result. Which frames there are, and what becomes of their rows and pictures, is not the loop's business: a
// film (film.cpp) keeps them in its folder, and a live session (live/session.h) shows them on a page.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/pictures/drawn_film.h"
#include "film/pictures/pictures.h"
#include "film/record/body_recorder.h"
#include "film/record/pair_recorder.h"
#include "output/motion/pose_table.h"

namespace supple {

// Tells a loop which frames to make, and takes their rows.
class FrameGuide {
 public:
  virtual ~FrameGuide() = default;
  // Is called before each frame, and may change the world or go back (FrameLoop::go_to). Returns how the loop ends;
  // nothing where the world's next frame is to be made.
  virtual std::optional<FilmEnd> ends() = 0;
  // Is called when a frame begins. Traces count what it does as part of the frame.
  virtual void begin() {}
  // Takes the row of a frame that was made, after its draw list, if it has one, was handed to the target.
  virtual void take(FrameRow row) = 0;
};

class FrameLoop {
 public:
  // Starts the world. All that is passed must outlive this object, but for `earlier`. folder: null where frames leave
  // no files. earlier: the rows of the frames that an earlier run made (FilmStart::kept_frames).
  FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder* folder,
            const FilmSolvers& solvers, const FrameRows& earlier);

  // Returns the stage of the pictures; null where the plan wants none. draw_on() sets the target that draws on it;
  // without a target, nothing is drawn.
  const Stage* stage() const { return drawn_ ? &drawn_->stage() : nullptr; }
  void draw_on(DrawListTarget& target) { pictures_ = &target; }

  // Makes the frames that the guide wants. Returns how the loop ended. When a step failed, or a state is not the one of
  // --verify, `message` says so; when the target refused a list, the target knows why.
  FilmEnd run(FrameGuide& guide, std::string& message);

  // Goes to a state of this world, earlier or later. before: the rows of all frames before it.
  void go_to(const WorldState& state, const FrameRows& before);
  // Lets these settings take the place of the scene's in all that is drawn from now on: path=value, of the field and
  // the look. The target must then draw on the new stage. Throws InputError, and then changes nothing.
  void change_look(const std::vector<std::string>& settings);
  // Ends the repetition of the cuts of an earlier run: from now on, steps keep to this run's own budgets of time.
  void end_repeats();
  // Returns the list of the world as it is, between two frames.
  DrawList present_list();
  // Hands that list to the target, if there is one. Returns false when the target has refused it.
  bool show_again();

 private:
  // These functions are the parts of a frame, in their order.
  void enter(int frame, FrameRow& row);
  std::string step(int frame, FrameRow& row);
  void record(int frame, FrameRow& row);
  bool show(int frame, FrameRow& row);

  std::string compare_with_record(int frame);
  void save_outputs(int frame, const FrameRow& row);
  void keep_motion();
  void continue_after(const FrameRows& before);
  DrawList list_of(int frame, double time, const FrameRow* row);

  const FilmPlan& plan_;
  World& world_;
  Threads threads_;
  bool graphs_;                              // whether the pictures have graphs
  std::vector<GraphPoint> graphed_;          // points of the frames so far, where the pictures have graphs
  StateVerifier* verifier_;                  // compares states for --verify; null without it
  bool compares_session_;                    // whether rows tell if a frame is as a live session has played it
  std::optional<DrawnFilm> drawn_;           // only with pictures
  std::optional<SceneDef> look_;             // has the look and the field that change_look() has put over the scene's
  std::vector<DrawnBody> skins_, elements_;  // by body, for change_look(); made when they are first wanted
  std::vector<Positions> last_motion_;  // of the bodies at the end of the last frame, where the pictures need it [m]
  WorldErrors errors_;                  // measures steps where the plan asks for it
  std::vector<std::unique_ptr<BodyRecorder>> recorders_;  // of each body
  std::optional<PairRecorder> pairs_;                     // notes the pairs of bodies that touch
  std::optional<PoseTableWriter> poses_;                  // only with colliders, and where there are files
  std::optional<StateRecorder> states_;                   // for --record
  DrawListTarget* pictures_ = nullptr;                    // null until there is one
};

}  // namespace supple
