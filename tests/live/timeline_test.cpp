// Tests that a session goes back to any of its frames with the bits that it had there, whatever was done before.
#include <gtest/gtest.h>

#include <fstream>

#include "live/timeline.h"
#include "support/bodies.h"
#include "support/played_world.h"

namespace supple {
namespace timeline_test {

class Session {
 public:
  Session() : world(test::world_of(SceneSource("scene.toml", test::bar_and_cube))), timeline(world) {}

  void play(int frames) {
    for (int i = 0; i < frames; ++i) {
      FrameRow row;
      row.frame = world.frames();
      row.bodies.resize(world.size());
      for (std::size_t b = 0; b < world.size(); ++b) row.bodies[b].name = world.bodies()[b].def.name;
      const auto note = [&](std::size_t body, int) {
        if (has_time_budget(world.body(body).inputs()))
          row.bodies[body].budget_cuts.push_back(world.body(body).report().cuts.after);
      };
      ASSERT_TRUE(world.play(world.frames(), {{}, note}));
      row.state_hash = world.hash();
      budgeted = row.bodies[0].budget_cuts.size();
      timeline.add(row, world);
    }
  }
  void set(const std::string& path, const std::string& value) {
    TimedChange change{path, {}, 0, 0, {}, {}, false, {}, {}, *ConfigValue::parse(value, "set"), {"set"}};
    world.change(change);
    timeline.add({world.frames(), change});
  }
  void grab(const LiveGrab& grab) {
    world.grab(grab);
    timeline.add({world.frames(), grab});
  }
  void release(const std::string& body, const std::string& handle) {
    world.release(body, handle);
    timeline.add({world.frames(), Release{body, handle}});
  }
  void go(int frames) {
    world.restore(timeline.state_before(frames, world.script().edits()));
    EXPECT_TRUE(timeline.remake(frames, world, [] { return false; }));
    timeline.cut(frames);
  }

  World world;
  Timeline timeline;
  std::size_t budgeted = 0;  // steps of the first body in the last frame that had a budget
};

// Does all that can be done, over 60 frames.
void do_much(Session& session) {
  session.set("body.bar.material.mu", "3e4");  // before the first frame
  session.play(4);
  session.grab({"cube", "hand-1", {1, 2, 3}, 200});
  session.set("body.cube.handles.hand-1.keys", "[{ t = 0.2, move = [0, 0.1, 0] }]");
  session.play(7);
  session.release("cube", "hand-1");
  session.grab({"cube", "hand-2", {2, 3, 4}, 100});
  session.play(12);
  session.set("solver.iterations", "20");
  session.set("body.bar.material.mu", "1e5");
  session.grab({"bar", "hand-3", {61, 62, 63}, 50});
  session.play(18);
  session.release("cube", "hand-2");
  session.set("body.bar.handles.hand-3.keys", "[{ t = 1.5, move = [0, 0.05, 0.05] }]");
  session.set("gravity", "[0, -5, 0]");
  session.play(19);
}

std::vector<std::uint64_t> hashes(const Session& session) { return session.timeline.played().hashes; }

TEST(Timeline, EveryFrameHasItsBitsAgain) {
  Session session;
  do_much(session);
  const std::vector<std::uint64_t> made = hashes(session);
  ASSERT_EQ(made.size(), 60u);
  for (const int frames : {59, 47, 40, 38, 23, 22, 11, 10, 9, 4, 3, 1}) {
    session.go(frames);
    EXPECT_EQ(session.world.frames(), frames);
    EXPECT_EQ(session.world.hash(), made[std::size_t(frames - 1)]) << frames;
  }
  session.go(0);
  EXPECT_EQ(session.world.frames(), 0);
  EXPECT_TRUE(session.world.script().edits().empty());
  do_much(session);
  EXPECT_EQ(hashes(session), made);
}

TEST(Timeline, WhatIsDoneAfterGoingBackIsAReplay) {
  Session session;
  do_much(session);
  session.go(33);
  session.set("gravity", "[0.5, -9, 0]");
  session.release("bar", "hand-3");
  session.play(12);
  session.grab({"bar", "hand-4", {60, 61}, 30});
  session.play(6);
  const test::TemporaryFolder folder;
  const ReplayFiles files = session.world.script().replay_files(folder.path / "saved.toml", session.world.frames(),
                                                                session.timeline.played());
  if (!files.scene.empty()) std::ofstream(files.scene) << files.scene_text;
  World again = test::world_of(SceneSource(folder.path / "saved.toml", files.replay_text));
  const PlayedSession& played = again.script().session();
  ASSERT_EQ(played.hashes, hashes(session));
  for (int frame = 0; frame < 51; ++frame) {
    ASSERT_TRUE(again.play(frame));
    EXPECT_EQ(again.hash(), played.hashes[std::size_t(frame)]) << frame;
  }
}

// The clock ends these steps anywhere, and going back must end them there again.
TEST(Timeline, StepsThatABudgetHasEndedEndThereAgain) {
  Session session;
  session.set("solver.iterations", "1000");
  session.play(3);
  session.set("solver.budget_ms", "0.03");  // for some ten of these small steps' iterations
  session.play(12);
  session.set("solver.budget_ms", "0");
  session.set("solver.iterations", "10");
  session.play(9);
  const std::vector<std::uint64_t> made = hashes(session);
  const PlayedSession played = session.timeline.played();
  EXPECT_EQ(played.cuts.size(), 12u * 2 * 2);
  const auto is_cut = [](const PlayedCut& cut) { return cut.cuts.after[0] >= 0; };
  EXPECT_TRUE(std::ranges::any_of(played.cuts, is_cut));
  for (const int frames : {23, 19, 14, 12}) {
    session.go(frames);
    EXPECT_EQ(session.world.hash(), made[std::size_t(frames - 1)]) << frames;
  }
  session.play(1);  // by the clock again
  EXPECT_EQ(session.budgeted, 2u);
}

TEST(Timeline, RemakingStopsBetweenFrames) {
  Session session;
  do_much(session);
  const std::vector<std::uint64_t> made = hashes(session);
  session.world.restore(session.timeline.state_before(39, session.world.script().edits()));
  const int begun = session.world.frames();
  EXPECT_FALSE(session.timeline.remake(39, session.world, [&] { return session.world.frames() == begun + 2; }));
  EXPECT_EQ(session.world.hash(), made[std::size_t(begun + 1)]);
}

}  // namespace timeline_test
}  // namespace supple
