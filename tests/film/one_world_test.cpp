// Tests that all who move a scene move it alike: the film, the states that it leaves, its redrawn pictures, the
// benchmarks' states, the frames that `supple info` simulates, and a world that is restored. What another program makes
// of it is tested in tests/library.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/bench/comparison.h"
#include "app/solvers.h"
#include "base/hash.h"
#include "film/frame_cost.h"
#include "film/plan/shipped_files.h"
#include "film/redraw/redraw.h"
#include "output/files/obj_file.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace one_world_test {

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

class OneWorld : public testing::Test {
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

TEST_F(OneWorld, StoredStatesAreThoseOfTheFilm) {
  for (const int frame : {1, 4, 7}) {
    const auto file = folder_.path / "out" / "s" / "states" / ("bar-00000" + std::to_string(frame)) / "state.json";
    EXPECT_EQ(nlohmann::json::parse(test::read_file(file))["state_hash"], hashes_[frame - 1]) << frame;
  }
}

TEST_F(OneWorld, TheBenchmarksStatesAreThoseOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  for (const char* how : {"played", "read back"}) {
    for (const BenchState& state : states_of(subject, {1, 4, 7}, folder_.path / "states", threads))
      EXPECT_EQ(hash_text_form(state.hash), hashes_[state.frame - 1]) << how << ", frame " << state.frame;
  }
}

TEST_F(OneWorld, FramesThatAreTriedOutAreThoseOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  for (const int frames : {1, 4, 9}) {
    subject.world.start(all_solvers().steps, &threads);
    const FrameCost cost = cost_of_frames(subject.world, frames).front();
    EXPECT_EQ(cost.failure, "");
    EXPECT_EQ(cost.frame_ms.size(), std::size_t(frames));
    EXPECT_EQ(hash_text_form(subject.world.hash()), hashes_[frames - 1]) << frames;
  }
}

// The film is continued from the states before, while and after the handle holds, in an order that makes the model's
// values change each time.
TEST_F(OneWorld, ACopyOfAStateIsASnapshot) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  const std::vector<BenchState> states = states_of(subject, {1, 4, 7}, folder_.path / "states", threads);
  World world = subject.new_world(scenes_own_solver(), threads);
  for (const int index : {1, 0, 2, 1}) {
    world.body(0).restore(states[index].before);
    for (int frame = states[index].frame; frame < 9; ++frame) {
      ASSERT_TRUE(world.play(frame));
      EXPECT_EQ(hash_text_form(world.hash()), hashes_[frame]) << "frame " << frame << " from " << states[index].frame;
    }
  }
}

// A comparison of solvers, on a state with a grabbing handle, must measure exactly the film's own step.
TEST_F(OneWorld, ComparisonsMakeTheStepOfTheFilm) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  SolverComparison comparison(subject, threads);
  const std::vector<BenchState> states = states_of(subject, {1, 4, 7}, folder_.path / "states", threads);
  for (const int index : {0, 1, 2, 0}) {
    World world = subject.new_world(scenes_own_solver(), threads);
    world.body(0).restore(states[index].before);
    bool is_first = true;
    Positions expected;
    ASSERT_TRUE(world.play(states[index].frame, {{}, [&](std::size_t, int) {
                                                   if (is_first) expected = world.body(0).state().x;
                                                   is_first = false;
                                                 }}));
    SolverEntry entry{"ours", Method::quasi_newton};
    entry.start.second_level = true;
    const Outcome outcome = comparison.run(states[index], {entry}, 0).front();
    EXPECT_EQ(outcome.x, expected) << index;
  }
}

TEST_F(OneWorld, RedrawnBodiesAreWhereTheFilmsAre) {
  Threads threads(1);
  Subject subject({scene_, "bar"});
  World world = subject.new_world(scenes_own_solver(), threads);
  DrawPlan plan;
  plan.run = folder_.path / "out" / "s";
  LoadedDrawing drawing = load_drawing(plan);
  const Vec3 origin = motion_origin(subject.body().description.mesh.rest);
  for (int frame = 0; frame < 9; ++frame) {
    ASSERT_TRUE(world.play(frame));
    const Positions moved = in_input_order(world.body(0).model(), world.body(0).state().x);
    const Positions kept = as_cached(moved.rowwise() - origin.transpose()).rowwise() + origin.transpose();
    EXPECT_EQ(saved_positions(drawing, 0, frame), kept) << frame;
  }
}

// The replay makes the bar stiffer in frames 3 to 5, and moves the ball's friction by a jump in frame 6.
TEST_F(OneWorld, AWorldReturnsToAnyOfItsStates) {
  const std::string replay = (folder_.path / "r.toml").string();
  std::ofstream(replay) << "scene = \"s.toml\"\n[[change]]\nt = 0.1\nover = 0.1\npath = "
                           "\"body.bar.material.mu\"\nvalue = 4e4\n[[change]]\nt = 0.2\npath = "
                           "\"collider.ball.friction\"\nvalue = 0.9\n";
  const test::Result film = test::run(folder_.path, {"replay", replay, "--no-images", "--quiet", "--out", "replayed"});
  ASSERT_EQ(film.status, 0) << film.err;
  std::vector<std::string> expected;
  const nlohmann::json profile = test::profile_of(folder_.path / "replayed");
  for (const auto& frame : profile["frames"]) expected.push_back(frame["state_hash"]);
  ASSERT_EQ(expected.size(), 9u);
  EXPECT_NE(expected[4], hashes_[4]);

  Threads threads(1);
  Script script = Script::load(scene_source(replay), assets_folder(), {});
  std::vector<Body> bodies = assemble(script.scene());
  World world(std::move(script), std::move(bodies));
  world.start(all_solvers().steps, &threads);
  std::vector<WorldState> states = {world.state()};
  for (int frame = 0; frame < 9; ++frame) {
    ASSERT_TRUE(world.play(frame));
    states.push_back(world.state());
    EXPECT_EQ(hash_text_form(world.hash()), expected[frame]) << frame;
  }
  for (const int from : {4, 0, 7, 5}) {
    world.restore(states[from]);
    for (int frame = from; frame < 9; ++frame) {
      ASSERT_TRUE(world.play(frame));
      EXPECT_EQ(hash_text_form(world.hash()), expected[frame]) << "frame " << frame << " from " << from;
    }
  }
  world.start(all_solvers().steps, &threads);
  for (int frame = 0; frame < 9; ++frame) {
    ASSERT_TRUE(world.play(frame));
    EXPECT_EQ(hash_text_form(world.hash()), expected[frame]) << "started anew, frame " << frame;
  }
}

}  // namespace one_world_test
}  // namespace supple
