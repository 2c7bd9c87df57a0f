// A few of the hard cases of `supple bench stability`, for the materials that they are hardest for.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "app/bench/stability_matrix.h"

namespace supple {
namespace {

StabilityOutcome outcome_of(const std::string& hard, const std::string& material) {
  const std::vector<HardCase> cases = hard_cases(std::nullopt);
  const std::vector<NamedMaterial> materials = stability_materials();
  const auto one = std::find_if(cases.begin(), cases.end(), [&](const HardCase& c) { return c.name == hard; });
  const auto of =
      std::find_if(materials.begin(), materials.end(), [&](const NamedMaterial& m) { return m.name == material; });
  EXPECT_NE(one, cases.end()) << hard;
  EXPECT_NE(of, materials.end()) << material;
  Threads threads(1);
  HardCase once = *one;
  once.seeds = 1;
  return run_case(once, *of, threads).front();
}

TEST(StabilityMatrix, HasNoTwoCasesOfOneName) {
  std::set<std::string> names;
  for (const HardCase& hard : hard_cases("meshes")) EXPECT_TRUE(names.insert(hard.name).second) << hard.name;
}

TEST(StabilityMatrix, SomeOfTheHardestCasesKeepTheirRules) {
  for (const char* material : {"neo-hookean", "stable-neo-hookean", "spline A"}) {
    for (const char* hard :
         {"stretched 3 times", "collapsed to a point", "squashed to 1 %", "impact of one size a step",
          "1e4 sizes from the origin", "free fall", "hanging from its end"}) {
      const StabilityOutcome outcome = outcome_of(hard, material);
      EXPECT_TRUE(outcome.passed()) << hard << ", " << material << ": " << outcome.failure;
    }
  }
}

// A body that is at rest has nothing to search for: the evaluations of its steps stay below those of a moving one.
TEST(StabilityMatrix, ABodyAtRestIsNoHarderThanAMovingOne) {
  for (const NamedMaterial& material : stability_materials()) {
    EXPECT_LT(outcome_of("free fall", material.name).trials, 12) << material.name;
    EXPECT_LT(outcome_of("stretched 3 times", material.name).trials, 25) << material.name;
  }
}

// Whatever breaks its rule is told of.
TEST(StabilityMatrix, NothingFailsInSilence) {
  for (const char* hard : {"mirrored", "random positions", "twisted 2 turns"}) {
    const StabilityOutcome outcome = outcome_of(hard, "neo-hookean");
    EXPECT_TRUE(outcome.passed() || outcome.told) << hard << ": " << outcome.failure;
  }
}

}  // namespace
}  // namespace supple
