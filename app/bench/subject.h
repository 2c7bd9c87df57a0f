// The bodies that solvers are compared on: one body of a scene each, and steps of it from stored states.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/threads.h"
#include "scene/driven_body.h"
#include "sim/solver/step.h"

namespace supple {

// A scene that ships (by name) or a file, one of its bodies, and "path=value" settings over the scene's.
struct SubjectChoice {
  std::string scene, body;
  std::vector<std::string> settings = {};
};

// The solver that a scene names, and another one in its place.
Solvers scenes_own_solver();
Solvers solver_instead(Method method, int iterations, SystemMatrix matrix = SystemMatrix::constant);

// One step to be made.
struct BenchState {
  int frame = 0;
  State before;  // of the frame's first step; handles have grabbed and let go already
  std::uint64_t hash = 0;
};

// A body that is ready to run. Throws InputError as loading a scene does, and when there is no such body.
struct Subject {
  explicit Subject(const SubjectChoice& choice);
  Subject(const Subject&) = delete;  // the driver refers to the other members
  Subject& operator=(const Subject&) = delete;

  SubjectChoice choice;
  std::string resolved;  // the scene with all settings, as JSON
  SceneDef scene;
  Body body;
  Model model;
  CollisionSet set;
  DrivenBody driver;  // by the scene's own solver

  // Puts the body into a state, and returns the inputs of the step from there. Renews the model where handles hold
  // otherwise than before.
  const StepInputs& inputs(const BenchState& state);
  std::string size_text() const;  // "3472 vertices, 10441 elements"
};

// Plays the scene with its own settings and keeps the states before these frames (ascending). A folder holds them for
// the next time, each with its problem (docs/states.md); a state that is there and belongs to this body is read back
// instead.
std::vector<BenchState> states_of(Subject& subject, const std::vector<int>& frames, const std::filesystem::path& folder,
                                  Threads& threads);

}  // namespace supple
