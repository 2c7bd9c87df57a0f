// Tests scenes with cloth that is curved at rest: that a shell keeps its shape where flat cloth falls open, that bits
// do not depend on threads, and what is refused.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "baselines/make_rule.h"
#include "support/bodies.h"
#include "support/scene_text.h"
#include "support/text_file.h"
#include "world/world.h"

namespace supple {
namespace curved_cloth_scene_test {

// Returns the OBJ text of a half cylinder of 0.2 m across that lies on its side like a gutter.
std::string gutter_text() {
  constexpr int around = 12, along = 10;
  std::string text;
  for (int i = 0; i <= around; ++i) {
    for (int k = 0; k <= along; ++k) {
      const double angle = std::numbers::pi * i / around;
      text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", -0.1 * std::cos(angle), -0.1 * std::sin(angle), 0.02 * k);
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < along; ++k) {
      const int a = i * (along + 1) + k + 1, b = a + along + 1;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, a + 1, b, b + 1, a + 1);
    }
  }
  return text;
}

class CurvedClothInAScene : public testing::Test {
 protected:
  CurvedClothInAScene() { test::write_text(folder_.path / "gutter.obj", gutter_text()); }

  // Returns the scene of the gutter that falls on the ground.
  std::string scene(const std::string& curved, const std::string& bend = "2e-2") const {
    return fmt::format(
        "frames = 40\n[[body]]\nname = \"gutter\"\ncloth = {{ surface = \"{}\", {} }}\n"
        "material = {{ fabric = \"denim\", bend = {} }}\ndensity = 0.2\nposition = [0, 0.1, 0]\n"
        "[[collider]]\nname = \"ground\"\nshape = {{ half_space = {{ normal = [0, 1, 0] }} }}\n",
        (folder_.path / "gutter.obj").string(), curved, bend);
  }

 private:
  test::TemporaryFolder folder_;
};

// Returns the width of the gutter after its film [m].
double width_at_end(const std::string& text, Threads* threads, std::uint64_t* hash = nullptr) {
  const SceneDef def = test::scene_of(text);
  World world(def, assemble(def));
  world.start({make_rule, settings_of}, threads);
  for (int i = 0; i < def.frames; ++i) EXPECT_TRUE(world.play(i, {}));
  if (hash != nullptr) *hash = world.hash();
  const Positions& x = world.body(0).state().x;
  return x.col(0).maxCoeff() - x.col(0).minCoeff();
}

TEST_F(CurvedClothInAScene, KeepsTheShapeThatFlatClothLoses) {
  EXPECT_NEAR(width_at_end(scene("curved = true"), nullptr), 0.2, 0.02);
  EXPECT_GT(width_at_end(scene("curved = false"), nullptr), 0.26);
}

TEST_F(CurvedClothInAScene, HasTheSameBitsForAnyNumberOfThreads) {
  std::uint64_t one = 0, two = 1;
  Threads threads(2);
  width_at_end(scene("curved = true"), nullptr, &one);
  width_at_end(scene("curved = true"), &threads, &two);
  EXPECT_EQ(one, two);
}

void expect_refused(const std::string& text, const std::string& words) {
  const std::vector<std::string> problems = test::problems_of(text);
  ASSERT_FALSE(problems.empty());
  EXPECT_NE(problems.front().find(words), std::string::npos) << problems.front();
}

TEST_F(CurvedClothInAScene, NeedsAFileAndAMaterialThatBends) {
  expect_refused(scene("curved = true", "0"), "curved: of a material with some bend");
  expect_refused(
      "[[body]]\nname = \"grid\"\ncloth = { extent = [1, 1], cells = [4, 4], curved = true }\nmaterial = \"silk\"\n",
      "a grid is flat");
}

}  // namespace curved_cloth_scene_test
}  // namespace supple
