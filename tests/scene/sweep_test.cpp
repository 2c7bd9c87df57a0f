// Tests sweeps as scene files describe them: their points, and where problems are reported.
#include "scene/reading/sweep.h"

#include <gtest/gtest.h>

#include <fstream>

#include "scene/reading/scene_reader.h"
#include "scene/replay/script.h"
#include "support/bodies.h"
#include "support/scene_text.h"

namespace supple {
namespace sweep_test {

constexpr const char* bar = R"([[body]]
name = "bar"
box = { extent = [1, 1, 1], cells = [1, 1, 1] }
material = { model = "corotated", mu = 1e4 }
)";

class Sweep : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& sweep) {
    const std::filesystem::path path = folder_.path / "scene.toml";
    std::ofstream(path) << bar << sweep;
    return path;
  }

  SweepDef load(const std::string& sweep, const std::vector<std::string>& settings = {}) {
    return load_sweep(write(sweep), test::assets, settings);
  }

  // Returns what checking the points reports, without the folder.
  std::string refusal(const std::string& sweep, const std::vector<std::string>& settings = {}) {
    try {
      const std::filesystem::path path = write(sweep);
      check_sweep_points(path, test::assets, settings, load_sweep(path, test::assets, settings));
    } catch (const InputError& error) {
      std::string text = error.what();
      const std::string folder = folder_.path.string() + "/";
      for (std::size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
      return text;
    }
    return "";
  }

  SceneDef point(const std::string& sweep, std::size_t index, std::string* json = nullptr) {
    const Script script = Script::load(write(sweep), test::assets, {}, index);
    if (json != nullptr) *json = script.scene_json();
    return script.scene();
  }

  test::TemporaryFolder folder_;
};

using Values = std::vector<std::string>;

TEST_F(Sweep, GridGoesThroughEveryCombinationTheFirstPathSlowest) {
  const SweepDef sweep =
      load("[sweep.values]\n\"solver.iterations\" = [5, 10]\n\"body.bar.material.mu\" = [1e4, 2.5, 3]\n");
  ASSERT_EQ(sweep.points(), 6u);
  EXPECT_EQ(sweep.axes[0].path, "solver.iterations");
  EXPECT_EQ(sweep.values(0), (Values{"5", "10000"}));
  EXPECT_EQ(sweep.values(1), (Values{"5", "2.5"}));
  EXPECT_EQ(sweep.values(3), (Values{"10", "10000"}));
  EXPECT_EQ(sweep.values(5), (Values{"10", "3"}));
}

TEST_F(Sweep, ListTakesTheValuesSideBySide) {
  const SweepDef sweep = load(
      "[sweep]\nmode = \"list\"\n[sweep.values]\n\"solver.iterations\" = [5, 10]\n\"body.bar.material.mu\" = [1, 2]\n");
  ASSERT_EQ(sweep.points(), 2u);
  EXPECT_EQ(sweep.values(0), (Values{"5", "1"}));
  EXPECT_EQ(sweep.values(1), (Values{"10", "2"}));
}

TEST_F(Sweep, PathsMayStandWithoutQuotesAndKeepTheOrderOfTheFile) {
  const SweepDef sweep = load("[sweep.values]\nsolver.iterations = [5]\nbody.bar.material.mu = [1]\nfps = [30]\n");
  ASSERT_EQ(sweep.axes.size(), 3u);
  EXPECT_EQ(sweep.axes[0].path, "solver.iterations");
  EXPECT_EQ(sweep.axes[1].path, "body.bar.material.mu");
  EXPECT_EQ(sweep.axes[2].path, "fps");
}

TEST_F(Sweep, APointsSceneHasTheValuesExactlyAndNoSweep) {
  const std::string text =
      "[sweep.values]\n\"body.bar.material.mu\" = [0.30000000000000004, 1e29]\n\"gravity\" = [[0, -1.5, 0], [0, 0, "
      "0]]\n"
      "\"body.bar.start\" = [{ stretch = [2, 1, 1] }]\n\"body.bar.name\" = [\"\\\"quoted\\\"\"]\n";
  std::string json;
  const SceneDef scene = point(text, 0, &json);
  EXPECT_EQ(std::get<Corotated>(scene.bodies[0].substance.material).mu, 0.30000000000000004);
  EXPECT_EQ(scene.gravity.y(), -1.5);
  EXPECT_EQ(scene.bodies[0].name, "\"quoted\"");
  EXPECT_EQ(scene.sweep_points, 0u);
  EXPECT_EQ(json.find("sweep"), std::string::npos);
  EXPECT_EQ(json, sweep_point_json(write(text), test::assets, {}, load(text), 0));
  EXPECT_EQ(std::get<Corotated>(point(text, 3).bodies[0].substance.material).mu, 1e29);
  EXPECT_EQ(load_scene(write(text), test::assets, {}).sweep_points, 4u);
  EXPECT_EQ(std::get<Corotated>(load_scene(write(text), test::assets, {}).bodies[0].substance.material).mu, 1e4);
}

TEST_F(Sweep, FilesAreLookedForBesideTheScene) {
  std::ofstream(folder_.path / "a.mesh") << "";
  const SceneDef scene = point("[sweep.values]\n\"body.bar.mesh\" = [\"a.mesh\"]\n", 0);
  EXPECT_EQ(scene.bodies[0].mesh, folder_.path / "a.mesh");
  EXPECT_FALSE(scene.bodies[0].box);
}

TEST_F(Sweep, CanBeGivenAsASetting) {
  const SweepDef sweep =
      load("", {"sweep.values.solver.iterations=[5, 10]", "sweep.values.body.bar.material.mu=[1, 2]"});
  EXPECT_EQ(sweep.points(), 4u);
  EXPECT_EQ(sweep.values(1), (Values{"1", "10"})) << "paths from the command line go by the alphabet";
}

TEST_F(Sweep, RefusesWhatTheFileSaysWrongAtItsPlace) {
  EXPECT_EQ(refusal("[sweep.values]\n\"solver.iterations\" = []\n"),
            "scene.toml:6:23: solver.iterations = []: must be a list of values, at least one");
  EXPECT_EQ(refusal("[sweep.values]\n\"solver.iterations\" = 5\n"),
            "scene.toml:6:23: solver.iterations = 5: must be a list of values, at least one");
  EXPECT_EQ(refusal("[sweep]\nmode = \"list\"\n[sweep.values]\nfps = [1, 2, 3]\n\"solver.iterations\" = [5, 10]\n"),
            "scene.toml:9:23: solver.iterations: 2 values; 'fps' has 3, and in mode \"list\" all have the same number");
  EXPECT_EQ(refusal("[sweep]\nmode = \"random\"\n[sweep.values]\nfps = [1]\n"),
            "scene.toml:6:8: mode = 'random': must be grid or list");
  EXPECT_EQ(refusal("[sweep]\nmod = \"grid\"\n[sweep.values]\nfps = [1]\n"),
            "scene.toml:6:1: unknown key 'mod'; did you mean 'mode'?");
  EXPECT_EQ(refusal("[sweep]\nmode = \"grid\"\n"), "scene.toml:5:1: 'values' is missing: lists of values by path");
  EXPECT_EQ(refusal("[sweep.values]\n"), "scene.toml:5:1: a sweep needs at least one path with a list of values");
  EXPECT_EQ(refusal("[sweep.values]\n\"solver.iterations\" = [5]\nsolver.iterations = [6]\n"),
            "scene.toml:7:21: 'solver.iterations' is listed twice");
  EXPECT_EQ(refusal("[sweep.values]\n\"sweep.mode\" = [\"list\"]\n"), "scene.toml:6:16: a sweep cannot vary itself");
}

TEST_F(Sweep, RefusesMoreThanAHundredThousandPoints) {
  std::string list = "[1";
  for (int i = 2; i <= 317; ++i) list += fmt::format(", {}", i);
  EXPECT_EQ(refusal("[sweep.values]\nfps = " + list + "]\nframes = " + list + "]\n"),
            "scene.toml:5:1: more than 100000 points");
}

TEST_F(Sweep, RefusesPathsAndValuesAtTheirPlaceOnce) {
  const std::string other = "fps = [20, 30]\n";
  EXPECT_EQ(refusal("[sweep.values]\n" + other + "\"body.bar.material.mv\" = [1e4]\n"),
            "scene.toml:7:27: unknown key 'mv'; did you mean 'mu'? (first in point 0 of the sweep: fps=20, "
            "body.bar.material.mv=10000)");
  EXPECT_EQ(
      refusal("[sweep.values]\n" + other + "\"solver.iterations\" = [5, -1]\n"),
      "scene.toml:7:27: iterations = -1: must be a whole number, 1 to 10000 (first in point 1 of the sweep: fps=20, "
      "solver.iterations=-1)");
  EXPECT_EQ(refusal("[sweep.values]\n\"body.rod.material.mu\" = [1e4]\n"),
            "scene.toml:6:27: there is no body named 'rod' (there is bar) (first in point 0 of the sweep: "
            "body.rod.material.mu=10000)");
  EXPECT_EQ(refusal("[sweep.values]\n\"bdoy.bar.material.mu\" = [1e4]\n"),
            "scene.toml:6:27: unknown key 'bdoy'; did you mean 'body'? (first in point 0 of the sweep: "
            "bdoy.bar.material.mu=10000)");
}

TEST_F(Sweep, VariesTheSceneThatAReplayStartsWith) {
  const std::filesystem::path scene = write("[sweep.values]\nfps = [10, 20]\n");
  const std::filesystem::path replay = scene.parent_path() / "replay.toml";
  const auto replay_to = [&](const std::string& value) {
    std::ofstream(replay) << "scene = \"scene.toml\"\ntitle = \"turned\"\n[[change]]\nt = 0.1\n"
                             "path = \"solver.iterations\"\nvalue = "
                          << value << "\n";
  };
  replay_to("7");
  const SweepDef sweep = load_sweep(replay, test::assets, {});
  ASSERT_EQ(sweep.points(), 2u);
  const Script second = Script::load(replay, test::assets, {}, 1);
  EXPECT_EQ(second.scene().fps, FrameRate(20));
  EXPECT_EQ(second.scene().title, "turned");
  EXPECT_EQ(second.changes().size(), 1u);
  const std::string before = sweep_point_json(replay, test::assets, {}, sweep, 1);
  replay_to("8");
  EXPECT_NE(sweep_point_json(replay, test::assets, {}, sweep, 1), before) << "a point would count as done";
}

TEST_F(Sweep, RefusesSettingsOfWhatItVariesAndFilesWithoutASweep) {
  EXPECT_EQ(refusal("[sweep.values]\nfps = [1]\n", {"fps=3"}), "--set fps=3: the sweep varies this");
  EXPECT_EQ(
      refusal(""),
      "scene.toml: has no [sweep] table; one can also be given, as in --set 'sweep.values.solver.iterations=[5, 10]'");
}

}  // namespace sweep_test
}  // namespace supple
