// Tests that the balance of energy has what is stored in the bending of cloth.
#include <gtest/gtest.h>

#include "baselines/make_rule.h"
#include "sim/model/bending.h"
#include "support/bodies.h"
#include "support/energy_watch.h"
#include "support/scene_text.h"

namespace supple {
namespace bending_energy_test {

World strip_held_at_an_end() {
  const std::string text =
      "frames = 6\n[[body]]\nname = \"strip\"\ncloth = { extent = [0.1, 0.3], cells = [4, 12] }\n"
      "material = \"denim\"\nturn_deg = [-90, 0, 0]\n"
      "[[body.handles]]\nname = \"edge\"\nselect = { box = [[0, 0, 0], [1, 0.1, 1]] }\n";
  World world(test::scene_of(text), assemble(test::scene_of(text)));
  world.start({make_rule, settings_of}, nullptr);
  return world;
}

TEST(BendingEnergy, IsInTheBalance) {
  World world = strip_held_at_an_end();
  MovingBody& body = world.body(0);
  body.workspace().prepare(body.model(), body.inputs().solver);
  EnergyBudget budget;
  budget.start(body.model(), body.inputs(), body.state(), body.workspace());
  Positions before;
  double counted = 0;
  const StepWatch watch{[&](std::size_t, int) {
                          budget.know_springs(body.model(), body.targets_at_start(), body.seams_at_start(),
                                              body.state());
                          budget.before_step(body.model(), body.inputs(), body.state(), body.workspace());
                          before = body.state().x;
                        },
                        [&](std::size_t, int) {
                          budget.after_step(body.model(), body.inputs(), before, body.state(), body.workspace());
                          counted = budget.energies().elastic;
                        }};
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(world.play(i, watch));
  const double bending = bending_energy(body.model(), body.state().x);
  const double elastic = elastic_energy(body.model(), body.workspace(), body.state().x);
  EXPECT_GT(bending, 0.1 * elastic);
  EXPECT_NEAR(counted, elastic, 1e-4 * elastic);
}

}  // namespace bending_energy_test
}  // namespace supple
