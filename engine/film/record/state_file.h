// Writes and reads folders that hold one step's problem: state.json and NumPy arrays. docs/states.md describes the
// format.
#pragma once

#include <filesystem>

#include "sim/solver/step_problem.h"

namespace supple {

constexpr int state_file_version = 2;

// Tells which step of which film a problem belongs to.
struct StepLabel {
  std::string scene, title;
  int frame = 0;
  int step = 0;  // counted from the start of the film; each frame has as many as the scene has substeps
};

// Creates the folder. state.json is written last, so a folder that has it is complete. Throws RunError when a file
// cannot be written.
void write_state(const std::filesystem::path& folder, const StepLabel& label, const StepProblem& problem);

struct StoredState {
  std::filesystem::path folder;  // the folder from which it was read
  std::string body;
  int frame = 0;
  double time = 0;               // [s]
  Positions q, v;                // in the order of the input file [m], [m/s]
  bool began_in_single = false;  // SolverMemory::began_in_single
};

// Reads a stored state. Throws InputError with the name of the file when it is missing or damaged, when it has another
// version, or when the state does not match its state_hash.
StoredState read_state(const std::filesystem::path& folder);

// Returns the state in the model's order. Throws InputError when the model has another number of vertices.
State state_for(const Model& model, const StoredState& stored);

}  // namespace supple
