// Moves the first iterate away from y where handles or turning make y a bad one. The paper starts from y. With the rows
// of held vertices eliminated, y tears the elements beside a handle apart by all that the handle did not do freely (its
// keyed motion, and the fall that it did not take), often by more than their size; and where parts turn fast, y
// stretches them, because velocities are straight. A remedy costs nothing where no handle departs from y and nothing
// turns. Otherwise it costs a solve, and one evaluation, because y stays the first iterate where y is better. What
// starting from y cost in earlier films is in docs/lab/2026-11-22-films-of-the-paper.md ("Error of the polynomial
// head").
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether y needs a remedy. Finds the turning parts (OpenWorkspace::turned). If handles depart from y, sets
// workspace.direction so that it leads from y to where their departure is spread into the body.
bool leaves_prediction(StepContext& c);

// Puts the first iterate where the direction of leaves_prediction() leads, with the turning parts turned, and evaluates
// it and y. The handles' departure is spread by the quadratic model that also gives the directions, A_ff d_f = -A_fh
// d_h: one solve.
void fit_handles_and_turning(StepContext& c);

// Tells whether the hard handles turn so far in the step that straight ways to their targets lead through each other:
// the body would start torn and inside out. Says no where the handles hold several parts, whose turns differ.
bool handles_turn_far(const StepContext& c);

// Tries two first iterates in which the body turns with its handles, for an evaluation each and one more solve. In the
// first, each vertex turns by its share s in the solution of A_ff s = -A_fh 1, the model that also spreads the handles'
// ways; in the second, the whole body turns, as a stiff body does. The current iterate stays where it is the better
// one.
void turn_with_handles(StepContext& c);

// Tells whether y, with the handles at their targets, is better than the iterate that was put in its place.
bool is_worse_than_prediction(const StepContext& c);

// Puts the first iterate back to y, where it is still to be evaluated.
void return_to_prediction(StepContext& c);

}  // namespace supple
