// A few of the hard cases of `supple bench stability`, for the materials that they are hardest for.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "app/bench/stability_matrix.h"

namespace supple {
namespace stability_matrix_test {

std::vector<StabilityOutcome> outcomes_of(const std::string& hard, const std::string& material, bool errors = false,
                                          const std::string& solver = "") {
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
  once.copies = std::min(once.copies, 4);
  const std::string heading = "[solver]\n";
  if (const std::size_t at = once.scene.find(heading); at != std::string::npos) {
    once.scene.insert(at + heading.size(), solver);
  } else if (!solver.empty()) {
    once.scene += "\n" + heading + solver;
  }
  return run_case(once, *of, threads, errors);
}

StabilityOutcome outcome_of(const std::string& hard, const std::string& material) {
  return outcomes_of(hard, material).front();
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

TEST(StabilityMatrix, UnlikeHalvesAndSpinKeepTheirRules) {
  for (const char* hard :
       {"Poisson's ratio 0.4999", "the free half 1e+02 times as stiff", "the held half 1e+06 times as stiff",
        "the free half 1e4 times as dense", "two parts, one held", "10 turns a second"}) {
    for (const char* material : {"neo-hookean", "stable-neo-hookean"}) {
      const StabilityOutcome outcome = outcome_of(hard, material);
      EXPECT_TRUE(outcome.passed()) << hard << ", " << material << ": " << outcome.failure;
    }
  }
}

// Materials of two halves, a second part and a spin are really there.
TEST(StabilityMatrix, CasesDifferFromTheirScenes) {
  const double usual = outcome_of("hanging from its end", "corotated").stretch;
  EXPECT_LT(outcome_of("the held half 1e+06 times as stiff", "corotated").stretch, usual - 0.05);
  const double light = outcome_of("light as air", "corotated").stretch;
  EXPECT_GT(outcome_of("the free half 1e4 times as dense", "corotated").stretch, light + 0.2);
  EXPECT_EQ(outcome_of("two parts, one held", "corotated").end.rows(),
            2 * outcome_of("hanging from its end", "corotated").end.rows());
  const StabilityOutcome spun = outcome_of("3 turns a second", "corotated");
  EXPECT_GT((spun.end - spun.start).rowwise().norm().maxCoeff(), 0.05);
  EXPECT_TRUE(outcomes_of("Poisson's ratio 0.49", "polynomial").empty());  // it has none
}

// Round-off is larger in single precision, and so is what unsolved steps make of it.
TEST(StabilityMatrix, ACaseThatIsTurnedHasTheSameAnswerTurned) {
  for (const auto& [elements, most] : {std::pair("double", 1e-5), std::pair("single", 1e-4)}) {
    for (const NamedMaterial& material : stability_materials()) {
      for (const char* hard : {"24 turned copies, hanging", "24 turned copies, spinning"}) {
        const std::vector<StabilityOutcome> copies =
            outcomes_of(hard, material.name, false, fmt::format("elements = \"{}\"\nstill = 0\n", elements));
        ASSERT_EQ(copies.size(), 4u);
        EXPECT_EQ(copies[0].turned_apart, 0);
        for (std::size_t copy = 1; copy < copies.size(); ++copy) {
          EXPECT_GT(copies[copy].turned_apart, 0) << "it was turned";
          // The polynomial has no stiffness at rest, so that its motion amplifies round-off; searches that turn parts
          // of the body forget their pairs, or do not, by a threshold.
          EXPECT_LT(copies[copy].turned_apart, material.name == "polynomial" ? 3e-2 : most)
              << hard << ", " << material.name << ", " << elements;
        }
      }
    }
  }
}

TEST(StabilityMatrix, ErrorsOfTheWorstStepFallWithTheIterations) {
  for (const char* material : {"neo-hookean", "corotated"}) {
    const std::optional<TabledErrors> errors = outcomes_of("hanging from its end", material, true).front().errors;
    ASSERT_TRUE(errors);
    EXPECT_GT(errors->ours[0].value(), 1e-6);
    EXPECT_LT(errors->ours[0].value(), 1e-2);
    EXPECT_LT(errors->ours[1].value(), 1e-3 * errors->ours[0].value());
    EXPECT_LE(errors->ours[2].value(), std::max(errors->ours[1].value(), 1e-14));  // round-off
    EXPECT_LT(errors->newton.value(), 1e-8);
  }
  // Nothing is left to gain in free fall, so there is nothing that an error could be a share of.
  EXPECT_FALSE(outcomes_of("free fall", "neo-hookean", true).front().errors->ours[0]);
}

// A body that is at rest has nothing to search for: the evaluations of its steps stay below those of a moving one.
TEST(StabilityMatrix, ABodyAtRestIsNoHarderThanAMovingOne) {
  for (const NamedMaterial& material : stability_materials()) {
    const double moving = outcome_of("shaken by its end", material.name).trials;
    EXPECT_GT(moving, 9) << material.name;
    EXPECT_LT(outcome_of("free fall", material.name).trials, 1.2 * moving) << material.name;
    EXPECT_LT(outcome_of("hanging from its end", material.name).trials, 1.2 * moving) << material.name;
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

}  // namespace stability_matrix_test
}  // namespace supple
