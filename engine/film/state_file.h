// Folders that hold one step's problem: state.json and NumPy arrays. docs/states.md describes the format.
#pragma once

#include <filesystem>

#include "sim/solver/step_problem.h"

namespace supple {

constexpr int state_file_version = 1;

// Tells which step of which film a problem belongs to.
struct StepLabel {
  std::string scene, title;
  int frame = 0;
  int step = 0;  // counted from the start of the film; as many a frame as the scene has substeps
};

// Makes the folder. state.json comes last: a folder that has it is whole. Throws RunError when the disk refuses.
void write_state(const std::filesystem::path& folder, const StepLabel& label, const StepProblem& problem);

struct StoredState {
  std::filesystem::path folder;  // where it was read
  std::string body;
  int frame = 0;
  double time = 0;  // [s]
  Positions q, v;   // in the order of the input file [m], [m/s]
};

// Throws InputError naming the file: missing or damaged, of another version, or not what its state_hash says.
StoredState read_state(const std::filesystem::path& folder);

// In the model's order. Throws InputError when the model has another number of vertices.
State state_for(const Model& model, const StoredState& stored);

}  // namespace supple
