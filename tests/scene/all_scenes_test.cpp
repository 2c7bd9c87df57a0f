// Tests every scene that ships: it steps, no step ends worse than staying, and the same bits come out for any number of
// threads. SUPPLE_SCENE_FRAMES sets how many frames are run (4 without it).
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "scene/building/assemble.h"
#include "scene/building/skin_report.h"
#include "scene/building/warnings.h"
#include "scene/reading/scene_reader.h"
#include "sim/measures/measures.h"
#include "support/film.h"
#include "support/objective_checks.h"

namespace supple {
namespace all_scenes_test {

int frames_to_run() {
  const char* wanted = std::getenv("SUPPLE_SCENE_FRAMES");
  return wanted != nullptr ? std::atoi(wanted) : 4;
}

std::vector<std::filesystem::path> scenes() {
  std::vector<std::filesystem::path> list;
  for (const auto& entry : std::filesystem::directory_iterator(test::assets / "scenes")) list.push_back(entry.path());
  std::sort(list.begin(), list.end());
  return list;
}

using test::Film;

TEST(Scenes, NoStepOfAnySceneIsWorseThanStaying) {
  for (const std::filesystem::path& path : scenes()) {
    const Film run(path, {});
    EXPECT_FALSE(run.scene.title.empty()) << path;
    run.play(2, frames_to_run(),
             [&](std::size_t b, int number, const State& before, const StepInputs& inputs, const State& after) {
               const Model& model = run.models[b];
               const auto [staying, change] = test::against_staying(model, inputs, before, after);
               EXPECT_LE(change, noise_of(model, staying, model.size + before.x.cwiseAbs().maxCoeff()))
                   << path.stem() << ", " << run.bodies[b].def.name << ", step " << number;
             });
  }
}

TEST(Scenes, GiveTheSameBitsForAnyNumberOfThreads) {
  for (const std::filesystem::path& path : scenes()) {
    const Film run(path, {});
    std::set<std::vector<std::uint64_t>> runs;
    for (const int threads : {1, 2, 4}) {
      std::vector<std::uint64_t> hashes;
      run.play(threads, frames_to_run(), [&](std::size_t b, int, const State&, const StepInputs&, const State& after) {
        hashes.push_back(state_hash(run.models[b], after));
      });
      runs.insert(hashes);
    }
    EXPECT_EQ(runs.size(), 1u) << path.stem();
  }
}

TEST(Scenes, TheHippoIsWholeAgainAfterTenSecondsFromRandomPositions) {
  for (const auto& [seed, levels] : {std::pair(1, 1), {2, 1}, {2, 2}, {3, 2}}) {
    const SceneDef scene = load_scene(test::assets / "scenes" / "hippo.toml", test::assets,
                                      {fmt::format("seed={}", seed), fmt::format("solver.levels={}", levels)});
    const Body body = assemble(scene).front();
    const Model model = build_model(body.description);
    StepInputs inputs{scene.gravity, {}, {}, body.def.solver.settings};
    inputs.targets.resize(0, 3);
    State state = start_state(model, body);
    EXPECT_GT(deformation(model, state.x).inverted, model.elements / 3);
    Threads threads(2);
    OpenWorkspace w;
    w.threads = &threads;
    for (int frame = 0; frame < 300; ++frame) ASSERT_FALSE(step(model, inputs, state, w).failed);
    const Deformation end = deformation(model, state.x);
    EXPECT_EQ(end.inverted, 0) << "seed " << seed;
    EXPECT_LT(end.stretch, 1.2) << "seed " << seed;
  }
}

TEST(Scenes, HaveNothingToWarnOf) {
  for (const std::filesystem::path& path : scenes()) {
    const SceneDef scene = load_scene(path, test::assets, {});
    const std::vector<Body> bodies = assemble(scene);
    for (const Problem& warning : said(warnings(scene, bodies))) ADD_FAILURE() << path.stem() << ": " << warning.text();
    const std::vector<DrawnBody> drawn = drawn_bodies(bodies);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const std::optional<Warning> skin = skin_warning(bodies[b], drawn[b]);
      EXPECT_TRUE(!skin || skin->meant) << path.stem() << ": " << skin->problem.text();
    }
  }
}

}  // namespace all_scenes_test
}  // namespace supple
