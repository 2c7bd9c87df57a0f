// Plays a body and goes on from copies of its states, as a film does that is resumed.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "base/threads.h"
#include "sim/model/state.h"
#include "sim/solver/step.h"

namespace supple::test {

// Expects that a body's states hold all that its next steps depend on: it comes to the same end from states on its way,
// with another model of the same body, on any number of threads, and in a workspace that has gone further.
// expect_same(a, b): compares what the states of two such ends remember besides positions and velocities.
template <class Compare>
void expect_states_to_hold_all(const BodyDescription& body, const StepInputs& inputs, const Compare& expect_same) {
  constexpr int steps = 16;
  const Model model = build_model(body), again = build_model(body);
  State state = rest_state(model);
  OpenWorkspace w;
  std::vector<State> states;
  for (int i = 0; i < steps; ++i) {
    states.push_back(state);
    step(model, inputs, state, w);
  }
  for (const int threads_count : {1, 2, 4}) {
    for (const int from : {3, 8, 13}) {
      Threads threads(threads_count);
      OpenWorkspace other;
      other.threads = &threads;
      State resumed = states[from];
      for (int i = from; i < steps; ++i) step(again, inputs, resumed, other);
      EXPECT_EQ(state_hash(again, resumed), state_hash(model, state)) << threads_count << " threads from " << from;
      expect_same(resumed, state);
    }
  }
  State back = states[5];
  step(model, inputs, back, w);
  EXPECT_EQ(state_hash(model, back), state_hash(model, states[6]));
}

}  // namespace supple::test
