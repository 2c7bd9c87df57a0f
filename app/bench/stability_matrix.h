// Plays hard cases (hard_cases.h) with every material and says whether each run kept its rule. docs/stability.md has
// the rules and what does not pass. This header is for the benchmark and its test.
#pragma once

#include <string>
#include <vector>

#include "app/bench/hard_cases.h"
#include "base/threads.h"

namespace supple {

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

// Plays a case for each of its seeds.
std::vector<StabilityOutcome> run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads);

}  // namespace supple
