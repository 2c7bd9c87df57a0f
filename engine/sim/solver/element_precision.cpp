#include "sim/solver/element_precision.h"

#include "sim/solver/objective.h"
#include "sim/solver/search_rule.h"

namespace supple {
namespace {

// Returns the energy that the round-off of gradients is worth [J]. The forces p on the strain of an element of
// stiffness k V are off by some u k V, where u is the round-off, and A is at least the sum of all G^T k V G. So the
// error e of the gradient has e^T A^-1 e of at most u^2 times the sum of k V.
double gradient_noise(const Model& model) { return single_round_off * single_round_off * model.strain_stiffness; }

constexpr double enough = 100;           // times the noise; the direction is then off by a tenth at most
constexpr double worth_beginning = 100;  // times `enough` times the noise: evaluating an iterate again must pay
constexpr int fewest_iterations = 4;

}  // namespace

bool is_single_enough(const Model& model, double slope) { return -slope > enough * gradient_noise(model); }

bool may_begin_in_single(const StepContext& c) {
  const SolverSettings& solver = c.inputs.solver;
  return c.rule.takes_single() && !c.model.has_slack && solver.elements == Precision::single_precision &&
         solver.line_search != LineSearch::none && solver.target_error == 0 && solver.iterations >= fewest_iterations;
}

void expect_precision(const StepContext& c) {
  c.w.began_in_single = false;
  const bool expected = c.state.memory.began_in_single && may_begin_in_single(c);
  c.w.elements = expected ? Precision::single_precision : Precision::double_precision;
}

void begin_in_single(const Model& model, double slope, OpenWorkspace& w) {
  w.began_in_single = is_single_enough(model, slope / worth_beginning);
  if (w.began_in_single) w.elements = Precision::single_precision;
}

bool go_over_to_double(const Model& model, OpenWorkspace& w) {
  if (w.elements == Precision::double_precision) return false;
  w.elements = Precision::double_precision;
  const double before = w.current.g;
  evaluate(model, w, w.current, Wanted::gradient);
  w.report.decrease += before - w.current.g;
  w.report.objective.back() = w.current.g;
  return true;
}

}  // namespace supple
