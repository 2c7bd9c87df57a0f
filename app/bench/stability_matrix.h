// Hard cases for every material, each with a rule that says whether the run passed: random, collapsed, mirrored and
// twisted starts; loads, impacts, spins; long and short steps; sizes from dust to mountains. docs/stability.md has the
// rules and what does not pass. This header is for the benchmark and its test.
#pragma once

#include <string>
#include <vector>

#include "base/threads.h"

namespace supple {

// Names the state in which a case must end.
enum class StableEnd {
  recovered,  // at rest: nothing inverted or without volume, no stretch left
  whole,      // nothing inverted or without volume
  bounded,    // finite, and no energy from nothing: all that physics promises
};

struct HardCase {
  std::string name;
  std::string scene;  // the text of a scene; MATERIAL stands for a table
  StableEnd end = StableEnd::bounded;
  std::string only = {};  // the one material that the case is about; empty: all
};

struct StabilityOutcome {
  bool finite = true;
  double from_nothing = 0;  // the worst of all frames, over the energy that was exchanged
  double stretch = 1;       // at the end
  int inverted = 0, collapsed = 0;
  double error_estimate = 0;  // the worst of all frames
  double trials = 0;          // evaluations a frame
  bool told = false;          // whether the run says that something is wrong
  std::string failure = {};   // the rule that was broken; empty: passed

  bool passed() const { return failure.empty(); }
};

struct NamedMaterial {
  std::string name, table;
};

// The materials with stiffnesses near 3e4 Pa.
std::vector<NamedMaterial> stability_materials();
std::vector<HardCase> hard_cases();

StabilityOutcome run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads);

}  // namespace supple
