// Estimates how far a step is from the minimum of g, without knowing it: what is left to gain, and the error of
// equation 12, its share of the whole possible gain. docs/method.md ("Error and its estimate") compares both with what
// is true.
#pragma once

#include "sim/solver/workspace.h"

namespace supple {

// Estimates what is left to gain from Newton's decrement |tr(grad^T d)|/2 at the last iterate [J].
double left_by_decrement(double decrement);

// Estimates it from how the decreases since objective[first] shrank, for rules that do not look beyond the last iterate
// [J].
double left_by_decreases(const std::vector<double>& objective, std::size_t first);

// Returns the share of what is left in the whole possible gain; both in J.
double error_of(double left, double gained);

// Tells whether the estimate has reached the target error of the settings.
bool is_near_enough(const StepReport& report, const SolverSettings& solver);

// Estimates the error at the end of a step that has gained so much [J]. A body at rest has next to nothing to gain;
// what is left is then no error, however much of it that is, where it is lost in the round-off of g.
double error_at_end(const Model& model, const Workspace& workspace, double gained);

}  // namespace supple
