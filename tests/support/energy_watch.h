// Watches the energy of a world's bodies, as a film's profile does.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sim/measures/energies.h"
#include "world/world.h"

namespace supple::test {

// Plays frames of a world from its start. Returns the largest share of energy from nothing of any body, and by
// reference all that was put into the first body.
inline double share_from_nothing(World& world, int frames, double& put_in) {
  std::vector<EnergyBudget> budgets(world.size());
  std::vector<Positions> before(world.size());
  for (std::size_t b = 0; b < world.size(); ++b) {
    MovingBody& body = world.body(b);
    body.workspace().prepare(body.model(), body.inputs().solver);
    budgets[b].start(body.model(), body.inputs(), body.state(), body.workspace());
  }
  double most = 0;
  const StepWatch watch{[&](std::size_t b, int) {
                          MovingBody& body = world.body(b);
                          budgets[b].know_springs(body.model(), body.targets_at_start(), body.seams_at_start(),
                                                  body.state());
                          budgets[b].before_step(body.model(), body.inputs(), body.state(), body.workspace());
                          before[b] = body.state().x;
                        },
                        [&](std::size_t b, int) {
                          MovingBody& body = world.body(b);
                          budgets[b].after_step(body.model(), body.inputs(), before[b], body.state(), body.workspace());
                          const EnergyBalance& balance = budgets[b].balance();
                          if (balance.exchanged() > 0) most = std::max(most, balance.from_nothing / balance.exchanged());
                        }};
  for (int i = 0; i < frames; ++i) EXPECT_TRUE(world.play(i, watch));
  put_in = budgets.front().balance().put_in;
  return most;
}

}  // namespace supple::test
