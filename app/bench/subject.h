// Prepares the bodies on which solvers are compared: each is one body of a scene, with steps of it from stored states.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/threads.h"
#include "sim/solver/step.h"
#include "world/world.h"

namespace supple {

// Selects a scene (the name of one that ships, or a file), one of its bodies, and "path=value" settings that override
// the scene's.
struct SubjectChoice {
  std::string scene, body;
  std::vector<std::string> settings = {};
};

// Says what directions of quasi-Newton start from. The default is the paper's.
struct DirectionStart {
  StartMatrix matrix = StartMatrix::system;
  bool second_level = false;  // whether they know how the body turns (sim/coarse/second_level.h)

  int levels() const { return second_level ? 2 : 1; }
};
std::string text_of(const DirectionStart& start);  // "system, two levels"

// Returns the scene of a text that a section has written, with "path=value" settings. name: what messages call it.
SceneDef scene_of_text(const std::string& text, const std::string& name, const std::vector<std::string>& settings = {});

// These functions return the solver that a scene names, or another solver in its place.
Solvers scenes_own_solver();
Solvers solver_instead(Method method, int iterations, DirectionStart start = {});

// Describes one step to be made.
struct BenchState {
  int frame = 0;
  State before;  // the state before the frame's first step; handles have grabbed and let go already
  std::uint64_t hash = 0;
};

// Holds one body of a scene, ready to run: a world of its own, in which it touches colliders alone. Throws InputError
// as loading a scene does, and when there is no such body.
struct Subject {
  explicit Subject(const SubjectChoice& choice);

  SubjectChoice choice;
  std::string resolved;  // the scene with all settings, as JSON
  World world;           // started with the scene's own solver

  const SceneDef& scene() const { return world.scene(); }
  const Body& body() const { return world.bodies().front(); }
  const Model& model() const { return world.body(0).model(); }
  // Returns another world of this body, at the start of the film. Its model has the same order and the same values.
  World new_world(const Solvers& solvers, Threads& threads) const;
  // Puts the body into a state, and returns the inputs of the step that starts there. Updates the model where other
  // handles hold than before.
  const StepInputs& inputs(const BenchState& state);
  std::string size_text() const;  // "3472 vertices, 10441 elements"
};

// Returns the states before these frames (ascending). Where `folder` has all of them for this body, they are read back.
// Otherwise the scene is simulated with its own settings, and the states are stored in `folder` for the next time, each
// with its problem (docs/states.md).
std::vector<BenchState> states_of(Subject& subject, const std::vector<int>& frames, const std::filesystem::path& folder,
                                  Threads& threads);

}  // namespace supple
