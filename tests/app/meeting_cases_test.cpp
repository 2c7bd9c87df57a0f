// The hard cases of bodies that meet, of `supple bench stability`: that their scenes are what they say, and that their
// rules see what happens.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "app/bench/meeting_run.h"
#include "support/bodies.h"

namespace supple {
namespace meeting_cases_test {

MeetingCase case_named(const std::string& part) {
  const std::vector<MeetingCase> cases = meeting_cases();
  const auto one =
      std::ranges::find_if(cases, [&](const MeetingCase& c) { return c.name.find(part) != std::string::npos; });
  EXPECT_NE(one, cases.end()) << part;
  return *one;
}

NamedMaterial material_named(const std::string& name) {
  const std::vector<NamedMaterial> materials = stability_materials();
  const auto one = std::ranges::find(materials, name, &NamedMaterial::name);
  EXPECT_NE(one, materials.end()) << name;
  return *one;
}

MeetingOutcome outcome_of(MeetingCase meeting, int substeps = 1) {
  meeting.scenes.resize(1);
  const test::TemporaryFolder folder;
  Threads threads(1);
  return run_meeting(meeting, material_named("stable-neo-hookean"), substeps, folder.path / "run", threads).front();
}

// Returns the case with another number of frames.
MeetingCase changed(MeetingCase meeting, int frames) {
  for (std::string& scene : meeting.scenes)
    scene.replace(0, scene.find('\n'), "frames = " + std::to_string(frames));  // its first line
  return meeting;
}

TEST(MeetingCases, HaveNamesOfTheirOwnAndMaterialsThatThereAre) {
  std::set<std::string> names;
  for (const MeetingCase& meeting : meeting_cases()) {
    EXPECT_TRUE(names.insert(meeting.name).second) << meeting.name;
    EXPECT_FALSE(meeting.scenes.empty()) << meeting.name;
  }
  for (const char* material : meeting_materials) material_named(material);
}

TEST(MeetingCases, StartInEachOtherWhereTheySaySo) {
  for (const MeetingCase& meeting : meeting_cases()) {
    const bool inside = meeting.name.find("start") != std::string::npos;
    EXPECT_EQ(outcome_of(changed(meeting, 1)).started_inside, inside) << meeting.name;
  }
}

// Two cubes that pass through each other are out of their order, and a film of them says that they do.
TEST(MeetingCases, AreFoundToHavePassedEachOther) {
  MeetingCase impact = case_named("3 edges a frame");
  for (const char* body : {"left", "right"}) {
    std::string& scene = impact.scenes.front();
    const std::string name = std::string("name = \"") + body + "\"\n";
    scene.insert(scene.find(name) + name.size(), "contact = { meets = false }\n");
  }
  const MeetingOutcome outcome = outcome_of(impact, 30);
  EXPECT_EQ(outcome.failure, "'left' and 'right' passed each other");
  EXPECT_FALSE(outcome.passed_all());
}

// Nothing has come to rest, nor apart, after a frame.
TEST(MeetingCases, AreFoundToMoveAndToBeDeepInEachOther) {
  const MeetingOutcome fallen = outcome_of(changed(case_named("1e4 times as soft"), 1));
  EXPECT_TRUE(fallen.failure.starts_with("still moves by ")) << fallen.failure;
  const MeetingOutcome inside = outcome_of(changed(case_named("deep in each other"), 1));
  EXPECT_GT(inside.depth_at_end, 0.05);
  EXPECT_FALSE(inside.passed_all());
}

}  // namespace meeting_cases_test
}  // namespace supple
