// Tests worlds that are changed while they are played: what they do is what a replay of it does, and what cannot be is
// refused without a trace.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "scene/replay/script_trial.h"
#include "support/bodies.h"
#include "support/played_world.h"
#include "world/world.h"

namespace supple {
namespace live_edits_test {

const std::string bar_and_ball = "fps = 20\n" + test::bar_and_cube + R"([[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, -1, 0]
)";

struct Played {
  explicit Played(const SceneSource& source, const std::vector<std::string>& settings = {})
      : world(test::world_of(source, settings)) {}
  std::vector<std::uint64_t> play(int frames) {
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < frames; ++i) {
      EXPECT_TRUE(world.play(world.frames()));
      hashes.push_back(world.hash());
    }
    return hashes;
  }
  void set(const std::string& path, const std::string& value, double over = 0) {
    TimedChange change{path, {}, 0, over, {}, {}, false, {}, {}, *ConfigValue::parse(value, "set"), {"set"}};
    world.change(std::move(change));
  }
  std::string refusal(const std::string& path, const std::string& value, double over = 0) {
    try {
      set(path, value, over);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  World world;
};

class LiveEdits : public testing::Test {
 protected:
  void SetUp() override { write("scene.toml", bar_and_ball); }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path / name) << text;
    return folder_.path / name;
  }
  Played played() { return Played(SceneSource(folder_.path / "scene.toml")); }
  // Saves what was done to a world, and plays it from its file.
  std::vector<std::uint64_t> replayed(const Played& done, const std::string& name = "saved.toml") {
    const std::filesystem::path file = folder_.path / name;
    const ReplayFiles files = done.world.script().replay_files(file, done.world.frames());
    if (!files.scene.empty()) std::ofstream(files.scene) << files.scene_text;
    std::ofstream(file) << files.replay_text;
    Played again{SceneSource(file)};
    EXPECT_EQ(again.world.scene().frames, done.world.frames());
    return again.play(done.world.frames());
  }

  test::TemporaryFolder folder_;
};

void append(std::vector<std::uint64_t>& list, const std::vector<std::uint64_t>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

TEST_F(LiveEdits, ValuesThatChangeAreAReplay) {
  Played live = played();
  live.set("body.bar.material.mu", "3e4");  // before the first frame
  std::vector<std::uint64_t> made = live.play(3);
  live.set("collider.ball.position", "[0, 0.1, 0]", 0.2);
  live.set("body.bar.material.mu", "1e5");
  live.set("body.cube.label", "\"a \\\"cube\\\"\"");
  append(made, live.play(3));
  live.set("solver.iterations", "20", 0.1);
  live.set("gravity", "[0.1, -3.3333333333333335, 1e-7]");
  append(made, live.play(4));
  EXPECT_EQ(replayed(live), made);
  EXPECT_NE(played().play(10).back(), made.back());
}

TEST_F(LiveEdits, GrabsAreAReplay) {
  Played live = played();
  live.world.grab({"cube", "before", {1, 2, 3}, 200});
  std::vector<std::uint64_t> made = live.play(2);
  live.world.grab({"bar", "hand", {61, 62, 63}, 50});
  live.set("body.bar.handles.hand.keys", "[{ t = 0, move = [0, 0.1, 0] }]");
  append(made, live.play(3));
  live.set("body.bar.handles.hand.stiffness", "80");
  live.world.release("cube", "before");
  append(made, live.play(2));
  live.world.release("bar", "hand");
  live.world.grab({"cube", "again", {2, 3, 4}, 100});  // two of these were held before
  append(made, live.play(3));
  live.world.grab({"bar", "last", {62}, 30});
  append(made, live.play(2));
  EXPECT_EQ(replayed(live), made);
}

TEST_F(LiveEdits, AReplayThatIsEditedIsAReplay) {
  const auto file = write("first.toml",
                          "scene = \"scene.toml\"\n[set]\n\"body.bar.density\" = 700\n[[grab]]\nbody = \"bar\"\n"
                          "name = \"own\"\nselect = { vertices = [60] }\nstiffness = 20\nfrom = 0.1\nuntil = 0.3\n"
                          "[[change]]\nt = 0.2\npath = \"body.bar.material.mu\"\nvalue = 2e4\n");
  Played live(SceneSource(file), {"solver.iterations=7", "body.cube.label=plain words"});
  std::vector<std::uint64_t> made = live.play(5);
  live.world.grab({"bar", "hand", {61}, 50});
  live.set("body.bar.material.mu", "3e4");
  append(made, live.play(4));
  EXPECT_EQ(replayed(live), made);
}

TEST_F(LiveEdits, ATextIsSavedBesideItsReplay) {
  Played live{SceneSource(folder_.path / "text", bar_and_ball)};
  std::vector<std::uint64_t> made = live.play(2);
  live.set("body.bar.material.mu", "3e4");
  append(made, live.play(2));
  EXPECT_EQ(replayed(live), made);
  EXPECT_TRUE(std::filesystem::exists(folder_.path / "saved-scene.toml"));
}

TEST_F(LiveEdits, FilesOfValuesAreFoundFromElsewhere) {
  std::ofstream(folder_.path / "shape.toml") << "[[part]]\nsphere = { radius = 0.3 }\n";
  const auto file = write("first.toml",
                          "scene = \"scene.toml\"\n[[change]]\nt = 0.1\npath = \"collider.ball.shape\"\n"
                          "value = \"shape.toml\"\n");
  Played live{SceneSource(file)};
  live.set("collider.ball.position", "[0, 0.1, 0]");
  const std::vector<std::uint64_t> made = live.play(6);
  std::filesystem::create_directory(folder_.path / "deep");
  EXPECT_EQ(replayed(live, "deep/saved.toml"), made);
}

TEST_F(LiveEdits, StatesBringTheirEdits) {
  Played live = played();
  (void)live.play(2);
  const WorldState plain = live.world.state();
  live.world.grab({"bar", "hand", {61, 62}, 50});
  live.set("body.cube.material.mu", "4e4");
  (void)live.play(2);
  const WorldState held = live.world.state();
  live.set("body.bar.handles.hand.keys", "[{ t = 0, move = [0, 0.1, 0] }]");
  const std::vector<std::uint64_t> ahead = live.play(3);
  live.world.restore(plain);
  EXPECT_TRUE(live.world.script().edits().empty());
  Played other = played();
  (void)other.play(2);
  EXPECT_EQ(live.play(4), other.play(4));
  other.world.restore(held);
  other.set("body.bar.handles.hand.keys", "[{ t = 0, move = [0, 0.1, 0] }]");
  EXPECT_EQ(other.play(3), ahead);
}

TEST_F(LiveEdits, WhatCannotBeLeavesNoTrace) {
  Played live = played();
  const std::vector<std::uint64_t> usual = played().play(6);
  (void)live.play(2);
  EXPECT_EQ(live.refusal("body.bar.position", "[0, 0, 0]"),
            "set: 'body.bar.position' cannot change while the film runs; `supple info --live SCENE` lists what can");
  EXPECT_EQ(live.refusal("body.ba.material.mu", "1"),
            "set: there is no body named 'ba' (there is bar or cube); did you mean 'bar'?");
  EXPECT_EQ(live.refusal("body.bar.material.mu", "-1"), "set: mu = -1: must be above 0 (first in frame 2)");
  EXPECT_EQ(live.refusal("body.bar.material.nu", "1", 1).substr(0, 21), "set: unknown key 'nu'");
  EXPECT_EQ(live.refusal("body.bar.handles.end.stiffness", "10"),
            (folder_.path / "scene.toml").string() +
                ":10:10: handle 'end' of body 'bar': hard handles stay hard, and springs stay springs");
  EXPECT_NE(live.refusal("body.bar.label", "3", 1), "");
  const auto grab_refused = [&](LiveGrab grab) { EXPECT_THROW(live.world.grab(std::move(grab)), InputError); };
  grab_refused({"bars", "hand", {1}, 10});
  grab_refused({"bar", "hand", {1000}, 10});
  LiveGrab taken{"bar", "hand", {}, 10};
  for (const std::int32_t v : live.world.bodies()[0].description.handles[0].vertices) taken.vertices.push_back(v + 1);
  grab_refused(taken);
  grab_refused({"bar", "end", {61}, 10});  // its name is taken
  grab_refused({"bar", "hand", {}, 10});
  grab_refused({"bar", "hand", {61}, -10});
  EXPECT_THROW(live.world.release("bar", "end"), InputError);
  EXPECT_THROW(live.world.release("bar", "hand"), InputError);
  EXPECT_TRUE(live.world.script().edits().empty());
  const std::vector<std::uint64_t> rest(usual.begin() + 2, usual.end());
  EXPECT_EQ(live.play(4), rest);
}

TEST_F(LiveEdits, AChangeIsCheckedWithThoseThatTheFilmMakesLater) {
  const auto file = write("first.toml",
                          "scene = \"scene.toml\"\nframes = 20\n[[change]]\nframe = 8\nover = 0.2\n"
                          "path = \"body.bar.material.mu\"\nvalue = 2e4\n");
  Played live{SceneSource(file)};
  (void)live.play(3);
  // From frame 8 on, the film's own ramp would lead through a material that has no mu.
  EXPECT_NE(live.refusal("body.bar.material", "{ model = \"spline\", f = [[0.5, -1], [1, 0], [2, 1]] }"), "");
  (void)live.play(10);
}

TEST_F(LiveEdits, AFrameThatIsStoppedIsFinishedLater) {
  Played live = played();
  const std::vector<std::uint64_t> usual = played().play(3);
  (void)live.play(1);
  StepWatch watch;
  watch.stops = [] { return true; };
  live.world.enter(1);
  EXPECT_FALSE(live.world.step(watch));
  EXPECT_TRUE(live.world.is_within_frame());
  EXPECT_TRUE(live.world.step());
  EXPECT_FALSE(live.world.is_within_frame());
  EXPECT_EQ(live.world.hash(), usual[1]);
  EXPECT_EQ(live.play(1).front(), usual[2]);
}

TEST_F(LiveEdits, AValueThatIsSetInEveryFrameCostsTheSame) {
  Played live = played();
  for (int frame = 0; frame < 400; ++frame) {
    live.set("gravity", "[0, -9, 0]");
    live.set("body.bar.handles.end.keys", "[{ t = 0, move = [0, 0.001, 0] }]");
    live.world.enter(frame);
  }
  EXPECT_EQ(live.world.script().changes().size(), 800u);
  EXPECT_EQ(live.world.scene().gravity.y(), -9);
}

TEST_F(LiveEdits, VerticesAreChosenByTheirNumbers) {
  const auto selected = [&](const std::string& list) {
    const auto file =
        write("scene.toml", bar_and_ball.substr(0, bar_and_ball.find("[[body.handles]]")) +
                                "[[body.handles]]\nname = \"end\"\nselect = { vertices = " + list + " }\n");
    return assemble(Script::load(SceneSource(file), test::assets, {}).scene())[0].description.handles[0].vertices;
  };
  EXPECT_EQ(selected("[3, 1, 3]"), (std::vector<std::int32_t>{0, 2}));
  EXPECT_THROW((void)selected("[64]"), InputError);
  EXPECT_THROW((void)selected("[0]"), InputError);
  EXPECT_THROW((void)selected("[]"), InputError);
  EXPECT_THROW((void)selected("[1.5]"), InputError);
}

TEST_F(LiveEdits, HandlesShareVerticesAtDifferentTimes) {
  const auto handles = [&](const std::string& second) {
    const auto file = write("r.toml",
                            "scene = \"scene.toml\"\n[[grab]]\nbody = \"cube\"\nname = \"a\"\nselect = { vertices = "
                            "[1, 2] }\nstiffness = 10\nfrom = 0.1\nuntil = 0.3\n[[grab]]\nbody = \"cube\"\nname = "
                            "\"b\"\nselect = { vertices = [2, 3] }\nstiffness = 10\n" +
                                second);
    return assemble(Script::load(SceneSource(file), test::assets, {}).scene())[1].description.handles;
  };
  EXPECT_EQ(handles("from = 0.3\n")[1].vertices, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(handles("from = 0.2\n")[1].vertices, (std::vector<std::int32_t>{2}));
  EXPECT_EQ(handles("from = 0\nuntil = 0.1\n")[1].vertices, (std::vector<std::int32_t>{1, 2}));
}

}  // namespace live_edits_test
}  // namespace supple
