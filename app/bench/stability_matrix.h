// Plays hard cases (hard_cases.h) with every material and says whether each run kept its rule. docs/stability.md has
// the rules and what does not pass. This header is for the benchmark and its test.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/bench/hard_cases.h"
#include "base/threads.h"
#include "base/types.h"

namespace supple {

inline constexpr double usual_young = 3e4, usual_poisson = 0.35;  // of the materials of hard cases; the first in [Pa]

// Lists the numbers of iterations after which the error of a case's worst step is measured.
constexpr std::array<int, 3> tabled_iterations = {10, 50, 200};

// Holds errors (equation 12) of one step against the lowest minimum that Newton's method finds from where any of the
// runs ended.
struct TabledErrors {
  std::array<std::optional<double>, tabled_iterations.size()> ours;  // nothing: there is no error but round-off
  std::optional<double> newton;                                      // after 50 iterations of Newton's method
};

struct StabilityOutcome {
  bool finite = true;
  double from_nothing = 0;  // energy from nothing: the worst of all frames, over the exchanged energy
  double stretch = 1;       // at the end
  int inverted = 0, collapsed = 0;
  double volume_change = 0;  // the worst of all frames, over the volume at rest
  double turned_apart = 0;   // distance from the first copy, turned back: the worst of all frames, over the body's size
  double error_estimate = 0;  // the worst of all frames
  double motion_error = 0;    // the worst of all frames, against the solved step; only where the case asks for it
  double trials = 0;          // evaluations a frame
  bool told = false;          // whether the run says that something is wrong
  std::string failure = {};   // the rule that was broken; empty: passed
  std::optional<TabledErrors> errors = {};  // errors of the step with the worst estimate, where they are asked for
  Positions start, end;                     // in the order of the mesh [m]
  Triangles surface;

  bool passed() const { return failure.empty(); }
  bool is_at_rest() const;  // whether the body is at rest at the end, whatever the rule
};

struct NamedMaterial {
  std::string name, table;
};

// Returns the materials, with stiffnesses near 3e4 Pa.
std::vector<NamedMaterial> stability_materials();

// Returns the table of one of these materials with another stiffness [Pa] and Poisson's ratio, which may lie beyond
// what a scene allows; nothing where the material has no Poisson's ratio and the wanted one is not the usual one.
std::optional<std::string> material_table(const std::string& name, double young, double poisson);

// Plays a case for each of its seeds, or for each of its turned copies. Returns no outcome where the material cannot
// have the case's Poisson's ratio. with_errors: whether the errors of the first run's worst step are measured.
std::vector<StabilityOutcome> run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads,
                                       bool with_errors = false);

}  // namespace supple
