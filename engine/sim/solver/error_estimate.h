// Estimates how far a step is from the minimum of g without knowing the minimum: the gain that is left, the error of
// equation 12, which is the share of this gain in the whole possible one, and the error of motion. docs/method.md
// ("Error and its estimate") compares the estimates of both errors with the true ones.
#pragma once

#include <array>

#include "sim/solver/open_workspace.h"

namespace supple {

// Follows the decrements |tr(grad^T d)| of a search's iterates, and estimates from them what is left to gain. All in J.
class Decrements {
 public:
  // Adds an iteration: the decrement where it began, and by how much it lowered g.
  void add(double decrement, double gained);

  // Estimates what is left to gain at an iterate with this decrement. Its comparison with each of the last four
  // decrements foretells a gain; the estimate is the geometric mean of these gains, but at least the decrement itself.
  // Before the first iteration, the estimate is the decrement.
  double left(double decrement) const;

 private:
  struct Iteration {
    double decrement, gained;
  };
  static constexpr int most = 4;
  std::array<Iteration, most> before_ = {};  // the newest first
  int count_ = 0;
};

// Estimates what is left to gain from how the decreases since objective[first] shrank, for rules that do not look
// beyond the last iterate [J].
double left_by_decreases(const std::vector<double>& objective, std::size_t first);

// Returns the error of equation 12, left / (left + gained). left: the gain that is left [J]; gained: the gain so far
// [J].
double error_of(double left, double gained);

// Returns what the step to the current iterate gained since y. gained: the decrease of g over its iterations, with what
// is known to have been gained before. All in J. Overwrites the trial iterate.
double gained_in_all(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, double gained);

// Estimates the error of equation 12 at the end of a step. gained: the step's gain so far [J]. What is left but lost in
// the round-off of g is no error, however large its share is: a body at rest has next to nothing to gain. Overwrites
// the trial iterate.
double error_at_end(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, double gained);

// Estimates the error of motion (model/motion_error.h) of a step from q to the current iterate by the length of the
// direction that begins there, which leads to the minimum of its quadratic model; of several parts, it is the largest.
// With one level, this model resists turning; the second level then adds what is missing, but for solids that A does
// not keep from turning. Returns 0 where the rule does not look beyond its last iterate. Leaves the way in the trial
// iterate's gradient.
double motion_ahead(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& workspace);

// Estimates the error of motion of the step by motion_ahead() and by what the lengths of earlier directions foretell
// (DirectionLengths::left). For a solid the estimate is their geometric mean, or a quarter of the first where that is
// more; for cloth it is their sum; and where the second is not known, it is the first. Where the iterations go on
// gaining as much as before and a material is loose at rest, the way ahead counts as longer, because what is left then
// is mostly motion that directions hardly show. longer: a factor of the way ahead. Overwrites the trial iterate and the
// workspace's scratch.
double motion_estimate(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& workspace,
                       double longer = 1);

// Writes motion_estimate() to the report: that of the whole model and, where it has several parts, one for each part.
// Writes the estimate by the way ahead alone to StepReport::motion_ahead; remedies of hard steps go by it.
void report_motion_estimates(const Model& model, const StepInputs& inputs, const Positions& q,
                             OpenWorkspace& workspace);

// Tells whether the estimates have reached the target error of the settings: of equation 12, and of motion where the
// step's start q (n x 3) is given. above_start: g(y) - g of the first iterate, which equation 12 counts as gained [J].
// Overwrites the trial iterate.
bool is_near_enough(const Model& model, const StepInputs& inputs, const Positions* q, double above_start,
                    OpenWorkspace& workspace);

// Tells whether the iterate is so near the minimum that nobody can see the rest: each part has less than the settings'
// `still` left to go, and both estimates of the step from q (n x 3) are small. A body at rest then costs next to
// nothing. gained: the step's gain so far [J]. Overwrites the trial iterate.
bool is_still(const Model& model, const StepInputs& inputs, const Positions& q, double gained,
              OpenWorkspace& workspace);

// Tells whether the iterate is so far from the minimum that a film would show it: a part has more than 1e-4 of its size
// left to go, and by the estimate more than 3 % of the motion of the step from q (n x 3) are missing. A step that has
// gone on beyond its iterations is far until the estimate is below 1 %, however short the way that is left. Goes by the
// last direction that was found, and so may be asked after an iteration, too. Overwrites the trial iterate and the
// workspace's scratch.
bool is_far(const Model& model, const StepInputs& inputs, const Positions& q, bool has_gone_on,
            OpenWorkspace& workspace);

}  // namespace supple
