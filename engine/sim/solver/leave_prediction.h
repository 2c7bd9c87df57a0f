// Moves the first iterate away from y where handles or turning make y a bad one. The paper starts from y. With rows
// eliminated, y tears the elements beside a handle apart by all that the handle did not do freely (its keyed motion,
// and the fall that it did not take), often by more than their size; and where parts turn fast, y stretches them,
// because velocities are straight. What each remedy costs: nothing where no handle departs from y and nothing turns;
// else one evaluation, because y stays the first iterate where it is the better one, and a solve. What starting
// from y cost in earlier films is in docs/lab/2026-11-22-films-of-the-paper.md ("Error of the polynomial head").
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether there is anything to mend: finds what turns (Workspace::turned), and sets the direction to that from y
// which spreads the handles' departure from y into the body, if they depart.
bool leaves_prediction(StepContext& c);

// Puts the first iterate where that direction leads, with what turns turned, and evaluates it and y. The handles'
// departure is spread by the quadratic model that also gives the directions, A_ff d_f = -A_fh d_h: one solve.
void fit_handles_and_turning(StepContext& c);

// Tells whether the hard handles turn so far in the step that straight ways to their targets lead through each other:
// the body would start torn and inside out.
bool handles_turn_far(const StepContext& c);

// Tries two first iterates in which the body turns with its handles, for an evaluation each and one more solve: each
// vertex by its share in the solution of A_ff s = -A_fh 1, by the model that spreads the handles' ways; or wholly, as a
// stiff body does. The current iterate stays where it is the better one.
void turn_with_handles(StepContext& c);

// Tells whether y, with the handles at their targets, is better than what was put in its place.
bool is_worse_than_prediction(const StepContext& c);

// Puts the first iterate back to y, not yet evaluated there as an iterate.
void return_to_prediction(StepContext& c);

}  // namespace supple
