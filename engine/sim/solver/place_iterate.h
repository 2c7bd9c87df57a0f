// Places and evaluates iterates, for everything in a step that tries one.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/objective.h"

namespace supple {

// Finds the contacts of an iterate; does nothing where nothing may touch.
void find_contacts_of(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Iterate& iterate);

// Finds the contacts of the trial iterate. Of cloth alone, they are those of the current iterate where no vertex has
// moved by ContactWork::kept_way since these were found (Iterate::keeps_contacts): what rests hardly moves. Of solids
// alone, friction that swings is eased (lagged_friction.h).
void find_trial_contacts(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace);

// Evaluates workspace.current, where a search begins, with the contacts found there. Appends the value to the report's
// objectives, and forgets the lengths of earlier directions.
void evaluate_start(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace);

// Drops what was counted and noted of a first iterate that was evaluated but from which the step does not start.
void forget_start(OpenWorkspace& workspace);

// Moves the free vertices of a part by a rigid motion.
void move_rigidly(const Part& part, const Eigen::Isometry3d& motion, Positions& x);

// Sets workspace.trial.x = x + alpha d for the free vertices, bent by the search's arc where it has one; held ones stay
// at their targets.
void set_trial(const Model& model, OpenWorkspace& workspace, double alpha);

}  // namespace supple
