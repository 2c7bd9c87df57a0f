// Tests that every part that makes a body's steps makes the same ones: the film, the states that it leaves, the
// benchmarks' states, and the frames that `supple info` simulates.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/bench/comparison.h"
#include "app/solvers.h"
#include "base/hash.h"
#include "film/frame_cost.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace {

// In this scene, implicit midpoint needs targets halfway, substeps need inputs of their own, one handle grabs in frame
// 3 and releases in frame 6, and the ball pushes from below.
const std::string driven_scene = R"(frames = 9
substeps = 2
[solver]
integrator = "implicit-midpoint"
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 1e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0, 1, 1]] }
stiffness = 60
keys = [{ t = 0 }, { t = 0.3, move = [0, 0.2, 0] }]
[[body.handles]]
name = "fingers"
select = { box = [[1, 0, 0], [1, 1, 1]] }
stiffness = 40
from = 0.1
until = 0.2
keys = [{ t = 0.1 }, { t = 0.2, move = [0.05, 0.1, 0] }]
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, 0.195, 0]
friction = 0.3
keys = [{ t = 0 }, { t = 0.3, move = [0, 0.15, 0] }]
)";

class OneDriver : public testing::Test {
 protected:
  void SetUp() override {
    scene_ = (folder_.path / "s.toml").string();
    std::ofstream(scene_) << driven_scene;
    const test::Result film =
        test::run(folder_.path, {"render", scene_, "--no-images", "--quiet", "--save-state", "1,4,7"});
    ASSERT_EQ(film.status, 0) << film.err;
    const nlohmann::json profile = test::profile_of(folder_.path / "out" / "s");
    for (const auto& frame : profile["frames"]) hashes_.push_back(frame["state_hash"]);
    ASSERT_EQ(hashes_.size(), 9u);
    EXPECT_GT(profile["frames"][4]["bodies"][0]["contacts"], 0);
  }

  test::TemporaryFolder folder_;
  std::string scene_;
  std::vector<std::string> hashes_;  // after each frame of the film
};

TEST_F(OneDriver, StoredStatesAreThoseOfTheFilm) {
  for (const int frame : {1, 4, 7}) {
    const auto file = folder_.path / "out" / "s" / "states" / ("bar-00000" + std::to_string(frame)) / "state.json";
    EXPECT_EQ(nlohmann::json::parse(test::read_file(file))["state_hash"], hashes_[frame - 1]) << frame;
  }
}

TEST_F(OneDriver, TheBenchmarksStatesAreThoseOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  for (const char* how : {"played", "read back"}) {
    for (const BenchState& state : states_of(subject, {1, 4, 7}, folder_.path / "states", threads))
      EXPECT_EQ(hash_text_form(state.hash), hashes_[state.frame - 1]) << how << ", frame " << state.frame;
  }
}

TEST_F(OneDriver, FramesThatAreTriedOutAreThoseOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  for (const int frames : {1, 4, 9}) {
    const FrameCost cost =
        cost_of_frames(subject.scene, subject.body, subject.model, subject.set, all_solvers().steps, threads, frames);
    EXPECT_EQ(cost.failure, "");
    EXPECT_EQ(cost.frame_ms.size(), std::size_t(frames));
    EXPECT_EQ(hash_text_form(state_hash(subject.model, cost.state)), hashes_[frames - 1]) << frames;
  }
}

// The film is continued from the states before, while and after the handle holds, in an order that makes the model's
// values change each time.
TEST_F(OneDriver, ACopyOfAStateIsASnapshot) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  const std::vector<BenchState> states = states_of(subject, {1, 4, 7}, folder_.path / "states", threads);
  DrivenBody driver(subject.scene, subject.body, subject.model, subject.set, scenes_own_solver(), &threads);
  for (const int index : {1, 0, 2, 1}) {
    driver.restore(states[index].before);
    for (int frame = states[index].frame; frame < 9; ++frame) {
      ASSERT_FALSE(driver.make_frame(frame, [](const StepReport&) {}).failed);
      EXPECT_EQ(hash_text_form(state_hash(driver.model(), driver.state())), hashes_[frame])
          << "frame " << frame << " from " << states[index].frame;
    }
  }
}

// A comparison of solvers, on a state with a grabbing handle, must measure exactly the film's own step.
TEST_F(OneDriver, ComparisonsMakeTheStepOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  SolverComparison comparison(subject, threads);
  const std::vector<BenchState> states = states_of(subject, {1, 4, 7}, folder_.path / "states", threads);
  for (const int index : {0, 1, 2, 0}) {
    DrivenBody driver(subject.scene, subject.body, subject.model, subject.set, scenes_own_solver(), &threads);
    driver.restore(states[index].before);
    driver.prepare_step(states[index].frame, 0);
    ASSERT_FALSE(driver.step().failed);
    const Positions expected = driver.state().x;
    SolverEntry entry{"ours", Method::quasi_newton};
    entry.start.levels = 2;
    const Outcome outcome = comparison.run(states[index], {entry}, 0).front();
    EXPECT_EQ(outcome.x, expected) << index;
  }
}

}  // namespace
}  // namespace supple
