// Describes a body of a film: the driver that makes its steps (scene/driven_body.h), and what the film records of it.
#pragma once

#include "film/plan/film_solvers.h"
#include "film/record/field_writer.h"
#include "film/record/repeated_cuts.h"
#include "output/motion/force_file.h"
#include "output/motion/point_cache.h"
#include "output/run/profile.h"
#include "output/run/run_folder.h"
#include "sim/solver/energies.h"

namespace supple {

class FilmedBody {
 public:
  // All that is passed by reference must outlive this object. kept_frames: number of frames of an earlier run's motion,
  // which stay and are continued.
  FilmedBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const RunFolder& folder,
             const FilmSolvers& solvers, Threads& threads, int kept_frames = 0);

  DrivenBody& driver() { return driver_; }
  const Model& model() const { return driver_.model(); }
  const State& state() const { return driver_.state(); }

  // Puts the body into a state of an earlier run, after the frame that a row tells of.
  void resume(const State& state, const BodyRow& row);

  // Lets the steps end where an earlier run's budgets ended them. cuts: must outlive this object.
  void repeat(const CutsByFrame& cuts) { repeated_ = &cuts; }

  // Makes one frame's steps. Returns a message when the solver failed.
  std::string advance(int frame, bool measure_error, BodyRow& row);

  // Appends the frame to motion/: the positions, and the forces of colliders where there are any.
  void save_motion();
  // Returns the frame's positions as motion/ holds them, in the order of the input file [m].
  const Positions& saved_motion() const { return saved_motion_; }
  // Returns the forces of colliders on the vertices in the same way [N]; without rows where there are no colliders.
  const Positions& saved_forces() const { return saved_forces_; }
  // Returns the present positions as motion/ would hold them.
  Positions present_motion() const;

  // Writes the problem of a frame's first step, which has not been made yet, into the folder of states. It changes no
  // result.
  void save_problem(int frame);

  // Writes the frame's fields into fields/.
  void save_fields(int frame);

 private:
  void start_energy_balance(const EnergyBalance& balance);
  const StepReport& make_step();
  void measure(int frame, BodyRow& row);
  MeasuredErrors step_errors(const State& before);

  const SceneDef& scene_;
  const RunFolder& folder_;
  const FilmSolvers& solvers_;
  Threads& threads_;
  DrivenBody driver_;
  const CutsByFrame* repeated_ = nullptr;  // null: the clock ends the steps that have a budget
  EnergyBudget energy_budget_;
  Positions start_of_step_;                  // q [m]
  std::unique_ptr<ErrorMeter> error_meter_;  // once an error is asked for
  std::uint64_t metered_model_ = 0;          // id of the model's values that the meter holds for
  PointCacheWriter motion_;
  std::optional<ForceFileWriter> forces_;  // where there are colliders
  Vec3 origin_;                            // of the files of motion [m]
  Positions saved_motion_;                 // in the world
  Positions saved_forces_;                 // [N]
  std::optional<FieldWriter> fields_;      // once fields are asked for
};

}  // namespace supple
