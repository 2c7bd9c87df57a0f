// What solvers are compared on: one body of a scene, and steps of it from stored states.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/threads.h"
#include "scene/assemble.h"
#include "scene/obstacle.h"
#include "sim/solver/step.h"

namespace supple {

// A scene that ships (by name) or a file, one of its bodies, and "path=value" settings over the scene's.
struct SubjectChoice {
  std::string scene, body;
  std::vector<std::string> settings = {};
};

// Ready to run. Throws InputError as loading a scene does, and when there is no such body.
struct Subject {
  explicit Subject(const SubjectChoice& choice);
  SubjectChoice choice;
  std::string resolved;  // the scene with all settings, as JSON
  SceneDef scene;
  Body body;
  Model model;
  CollisionSet set;

  // Of the first step of a frame.
  FrameInputs inputs(int frame) const;
  std::string size_text() const;  // "3472 vertices, 10441 elements"
};

// One step to be made.
struct BenchState {
  int frame = 0;
  State before;
  std::uint64_t hash = 0;
};

// Plays the scene with its own settings and keeps the states before these frames (ascending). A folder holds them for
// the next time, each in a state folder (docs/states.md), which is read back instead when it is there and belongs to
// this body.
std::vector<BenchState> states_of(const Subject& subject, const std::vector<int>& frames,
                                  const std::filesystem::path& folder, Threads& threads);

}  // namespace supple
