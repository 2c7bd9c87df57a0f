// Records a body of a world: its rows of the profile, its motion, its forces, its fields and its states. It looks at
// the steps that the world makes, and makes none.
#pragma once

#include "film/record/field_writer.h"
#include "film/record/repeated_cuts.h"
#include "film/record/world_errors.h"
#include "output/motion/force_file.h"
#include "output/motion/point_cache.h"
#include "output/run/profile.h"
#include "output/run/run_folder.h"
#include "sim/measures/energies.h"
#include "world/world.h"

namespace supple {

// Adds what a step knows of itself to the row of its frame.
void add_up(StepRow& row, const StepReport& report);

// Says in a line that a step failed, and where.
std::string failure_text(int frame, const std::string& body, const StepFailure& failure);

class BodyRecorder {
 public:
  // The world must have been started; it and all that is passed by reference must outlive this object. folder: null
  // where nothing is written. kept_frames: the number of frames of an earlier run's motion, which stay and are
  // continued.
  BodyRecorder(World& world, std::size_t body, const RunFolder* folder, WorldErrors& errors, int kept_frames = 0);

  // Goes on after a frame of an earlier run, once the world has been restored. row: the body's row of that frame.
  void resume(const BodyRow& row);
  // Lets the steps end where an earlier run's budgets ended them, as far as its frames go. cuts: the cuts of that run;
  // they must outlive this object.
  void repeat(const CutsByFrame& cuts) { repeated_ = &cuts; }
  // Lets the clock end the steps from now on.
  void end_repeats();

  // Begins the row of a frame, before its first step. measure_error: whether the errors of the frame's last step are
  // measured. row: the row to be filled in; it must stay where it is until the frame is over.
  void begin_frame(int frame, bool measure_error, BodyRow& row);
  // These two are called for each step of the body (StepWatch).
  void before_step(int substep);
  void after_step(int substep);
  // Completes the row, after the frame's last step.
  void end_frame();
  // Says why the last step failed; empty where it did not.
  std::string failure() const;

  // Notes the frame's positions, and the forces of contact where the scene has anything to touch, and appends them to
  // motion/.
  void save_motion();
  // Notes the present positions and forces, as save_motion() does, and appends nothing.
  void note_motion();
  // Returns the frame's positions as motion/ holds them, in the order of the input file [m].
  const Positions& saved_motion() const { return saved_motion_; }
  // Returns the forces of contact on the vertices as motion/ holds them, in the order of the input file [N]; without
  // rows where the scene has one body and no collider.
  const Positions& saved_forces() const { return saved_forces_; }
  // Returns the present positions as motion/ would hold them.
  Positions present_motion() const;
  // Writes the problem of a frame's first step, for which the world is prepared, into the folder of states. It changes
  // no result. This function and save_fields() need a folder.
  void save_problem(int frame);
  // Writes the frame's fields into fields/.
  void save_fields(int frame);

 private:
  MovingBody& moving() { return world_.body(body_); }
  const MovingBody& moving() const { return world_.body(body_); }
  const Model& model() const { return moving().model(); }
  const State& state() const { return moving().state(); }
  const Body& body() const { return moving().body(); }
  bool is_measured(int substep) const { return measures_error_ && substep + 1 == world_.scene().substeps; }
  Positions cached_motion() const;
  void note_forces();
  void start_energy_balance(const EnergyBalance& balance);
  void measure_errors();
  void measure_contact();
  void measure_seams();

  World& world_;
  std::size_t body_;
  const RunFolder* folder_;  // null where nothing is written
  WorldErrors& errors_;
  const CutsByFrame* repeated_ = nullptr;  // null: the clock ends the steps that have a budget
  int frame_ = 0;                          // in progress
  bool measures_error_ = false;
  BodyRow* row_ = nullptr;  // the body's row of the frame in progress
  EnergyBudget energy_budget_;
  Positions start_of_step_;                 // q [m]
  std::optional<PointCacheWriter> motion_;  // these two where files are written
  std::optional<ForceFileWriter> forces_;   // where there is anything to touch
  Vec3 origin_;                             // of the files of motion [m]
  Positions saved_motion_;                  // the frame's positions in the world [m]
  Positions saved_forces_;                  // [N]
  std::optional<FieldWriter> fields_;       // made when fields are first asked for
};

}  // namespace supple
