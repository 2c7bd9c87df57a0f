// Tests films that go on from a frame of an earlier run (--from).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/program.h"
#include "support/text_file.h"

namespace supple {
namespace earlier_run_test {

using test::profile_of;
using test::read_file;
using test::Result;
using test::run;

constexpr int frames = 24, last_before = 9;

// Holds a run of a bar that a handle turns, and of a ball that keeps dents, above a moving stone; a replay changes
// stiffness and gravity, and there is a checkpoint after a few frames.
class EarlierRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    std::ofstream(path("bar.toml")) << R"(frames = 24
substeps = 2
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0, 1, 1]] }
keys = [{ t = 0 }, { t = 0.8, turn_deg = [0, 0, 60] }]
[[body]]
name = "ball"
box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }
position = [0.1, 0.5, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
plastic = { yield = 300, hardening = 1e3 }
[[collider]]
name = "stone"
shape = { sphere = { radius = 0.1 } }
position = [0.1, 0.12, 0]
keys = [{ t = 0 }, { t = 0.8, move = [0.1, 0, 0] }]
[camera]
shutter = 180
[output]
width = 96
height = 64
samples = 1
blur_samples = 2
)";
    std::ofstream(path("replay.toml")) << R"(scene = "bar.toml"
[[change]]
t = 0.1
over = 0.5
path = "body.bar.material.mu"
value = 4e4
[[change]]
t = 0.5
path = "gravity"
value = [0, -5, 0]
)";
    whole_ = run(folder(), {"replay", "replay.toml", "--out", "whole", "--no-video", "--checkpoint-every", "6"});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static const std::filesystem::path& folder() { return folder_->path; }
  static std::filesystem::path path(const std::string& name) { return folder() / name; }

  static Result go_on(const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = {"replay", "replay.toml", "--out", out, "--no-video", "--from", "whole"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder(), words);
  }
  static std::string number(int n) { return fmt::format("{}", n); }

  static std::unique_ptr<test::TemporaryFolder> folder_;
  static Result whole_;
};
std::unique_ptr<test::TemporaryFolder> EarlierRun::folder_;
Result EarlierRun::whole_;

TEST_F(EarlierRun, GoesOnWithTheSameBitsTimesAndPictures) {
  ASSERT_EQ(whole_.status, 0) << whole_.err;
  const int rest = frames - last_before - 1;
  const Result later = go_on("later", {"--frame", number(last_before), "--frames", number(rest)});
  ASSERT_EQ(later.status, 0) << later.err;
  EXPECT_NE(later.err.find("goes on after frame 9"), std::string::npos) << later.err;
  const nlohmann::json then = profile_of(path("whole"))["frames"], now = profile_of(path("later"))["frames"];
  ASSERT_EQ(now.size(), std::size_t(rest));
  for (int f = 0; f < rest; ++f) {
    const auto &a = then[std::size_t(last_before + 1 + f)], &b = now[std::size_t(f)];
    EXPECT_EQ(a["state_hash"], b["state_hash"]) << f;
    EXPECT_EQ(a["time_s"], b["time_s"]) << f;
    EXPECT_EQ(read_file(path(fmt::format("whole/frames/{:06}.png", last_before + 1 + f))),
              read_file(path(fmt::format("later/frames/{:06}.png", f))))
        << f;
  }
  const Result drawn = run(folder(), {"draw", "later", "--out", "drawn"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_EQ(read_file(path("drawn/frames/000000.png")), read_file(path("later/frames/000000.png")));
  EXPECT_NE(run(folder(), {"compare", "whole", "later"}).out.find("frame 0 is at 0.03333 s in A and at 0.3667 s in B"),
            std::string::npos);
  EXPECT_EQ(run(folder(), {"compare", "later", "later"}).out.find("clock"), std::string::npos);
  const auto distance = [&](const std::string& of, const std::string& to, const std::string& still) {
    return run(folder(), {"draw", of, "--frame", "3", "--still", still, "--field", "distance", "--range", "0,0.1",
                          "--reference", to});
  };
  ASSERT_EQ(distance("later", "later", "own.png").status, 0);
  ASSERT_EQ(distance("later", "whole", "other.png").status, 0);
  EXPECT_EQ(read_file(path("own.png")), read_file(path("other.png"))) << "both are compared at the same time";
  const Result early = distance("whole", "later", "early.png");
  EXPECT_NE(early.err.find("starts 10 frames after the frame 0"), std::string::npos) << early.err;
}

TEST_F(EarlierRun, GoesOnInTheMiddleOfABounce) {
  test::write_text(path("bounce.toml"), R"(fps = 120
[[body]]
shape = "shapes/sphere.toml"
size = 0.2
vertices = 200
position = [0, 0.02, 0]
velocity = [0, -2, 0]
material = { model = "neo-hookean", young = 2e4, poisson = 0.4 }
contact = { restitution = 0.8 }
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
)");
  ASSERT_EQ(run(folder(), {"render", "bounce.toml", "--out", "bounce", "--frames", "20", "--no-images"}).status, 0);
  const nlohmann::json then = profile_of(path("bounce"))["frames"];
  for (const int frame : {3, 6}) {
    const Result later =
        run(folder(), {"render", "bounce.toml", "--out", "rest-of-bounce", "--from", "bounce", "--frame", number(frame),
                       "--frames", number(19 - frame), "--no-images", "--force"});
    ASSERT_EQ(later.status, 0) << later.err;
    EXPECT_EQ(profile_of(path("rest-of-bounce"))["frames"].back()["state_hash"], then[19]["state_hash"]) << frame;
  }
}

TEST_F(EarlierRun, StartsFromTheCheckpointOfTheRunWhereThatIsEarlyEnough) {
  const Result late = go_on("late", {"--frame", "23", "--frames", "2", "--no-images"});
  ASSERT_EQ(late.status, 0) << late.err;
  EXPECT_NE(late.err.find("its checkpoint is used"), std::string::npos) << late.err;
  const Result longer = run(folder(), {"replay", "replay.toml", "--out", "longer", "--no-images", "--frames", "26"});
  ASSERT_EQ(longer.status, 0) << longer.err;
  EXPECT_EQ(profile_of(path("late"))["frames"][1]["state_hash"],
            profile_of(path("longer"))["frames"][25]["state_hash"]);
}

TEST_F(EarlierRun, GoesOnFromARunThatWentOnItself) {
  ASSERT_EQ(go_on("second", {"--frame", "9", "--frames", "6", "--no-images"}).status, 0);
  const Result third = run(folder(), {"replay", "replay.toml", "--out", "third", "--no-images", "--from", "second",
                                      "--frame", "3", "--frames", "2"});
  ASSERT_EQ(third.status, 0) << third.err;
  const nlohmann::json then = profile_of(path("whole"))["frames"], now = profile_of(path("third"))["frames"];
  for (std::size_t f = 0; f < 2; ++f) {  // frame 3 of the second is frame 13 of the first
    EXPECT_EQ(now[f]["time_s"], then[14 + f]["time_s"]) << f;
    EXPECT_EQ(now[f]["state_hash"], then[14 + f]["state_hash"]) << f;
  }
  const Result clock = run(folder(), {"check", "replay.toml", "--set", "from={run=\"second\",frame=3,clock=0.2}"});
  EXPECT_EQ(clock.status, 0) << clock.err;
  const Result wrong = run(folder(), {"replay", "replay.toml", "--no-images", "--out", "wrong", "--set",
                                      "from={run=\"second\",frame=3,clock=0.2}"});
  EXPECT_NE(wrong.err.find("frame 3 of second ended at 0.466666667 s, and not at 0.2 s"), std::string::npos)
      << wrong.err;
}

TEST_F(EarlierRun, KeepsTheClockWhereItHasAnotherRate) {
  const Result finer = go_on("finer", {"--frame", "9", "--frames", "4", "--no-images", "--set", "fps=60"});
  ASSERT_EQ(finer.status, 0) << finer.err;
  const nlohmann::json rows = profile_of(path("finer"))["frames"];
  EXPECT_NEAR(rows[0]["time_s"].get<double>(), 10.0 / 30 + 1.0 / 60, 1e-12);
  EXPECT_NEAR(rows[3]["time_s"].get<double>(), 12.0 / 30, 1e-12);
  const Result later = run(folder(), {"render", "bar.toml", "--out", "coarse", "--no-images", "--frames", "2", "--from",
                                      "finer", "--frame", "3", "--set", "fps=30"});
  ASSERT_EQ(later.status, 0) << later.err;
  EXPECT_NEAR(profile_of(path("coarse"))["frames"][0]["time_s"].get<double>(), 13.0 / 30, 1e-12);
  const Result between = go_on("refused", {"--frame", "9", "--no-images", "--set", "fps=25"});
  EXPECT_EQ(between.status, 2);
  EXPECT_NE(between.err.find("ends at 0.333333 s, which is between two frames of this film, at 25 a second"),
            std::string::npos)
      << between.err;
}

// Bodies of one table, and bodies that touch.
TEST_F(EarlierRun, GoesOnWithManyBodiesOfAFew) {
  std::ofstream(path("pile.toml")) << R"(frames = 20
[[body]]
name = "lump"
box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }
material = "jelly"
start_inside = "move"
[[scatter]]
bodies = ["lump"]
count = 6
box = [[0, 0, 0], [0.15, 0.3, 0.15]]
[[collider]]
shape = { half_space = { normal = [0, 1, 0], offset = 0.01 } }
)";
  ASSERT_EQ(run(folder(), {"render", "pile.toml", "--out", "pile", "--no-images"}).status, 0);
  const Result later = run(folder(), {"render", "pile.toml", "--out", "rest", "--no-images", "--frames", "4", "--from",
                                      "pile", "--frame", "15"});
  ASSERT_EQ(later.status, 0) << later.err;
  EXPECT_EQ(profile_of(path("rest"))["frames"][3]["state_hash"], profile_of(path("pile"))["frames"][19]["state_hash"]);
  EXPECT_EQ(later.err.find("before the first frame"), std::string::npos) << later.err;
  EXPECT_EQ(later.err.find("overlap at the start"), std::string::npos) << later.err;
}

TEST_F(EarlierRun, IsResumedWithTheSameBits) {
  const std::vector<std::string> words = {"--frame", "9", "--frames", "12", "--no-images", "--checkpoint-every", "4"};
  ASSERT_EQ(go_on("straight", words).status, 0);
  std::vector<std::string> shorter = words;
  shorter[3] = "6";
  ASSERT_EQ(go_on("cut", shorter).status, 0);
  std::vector<std::string> resumed = words;
  resumed.push_back("--resume");
  const Result result = go_on("cut", resumed);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("resuming after frame 6"), std::string::npos) << result.err;
  EXPECT_EQ(profile_of(path("straight"))["frames"][11]["state_hash"],
            profile_of(path("cut"))["frames"][11]["state_hash"]);
}

TEST_F(EarlierRun, TakesChangedValuesNewBodiesAndNewColliders) {
  std::ofstream(path("other.toml")) << read_file(path("bar.toml")) << R"(
[[body]]
name = "third"
box = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }
position = [-1, 1, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
[[collider]]
name = "floor"
shape = { half_space = { normal = [0, 1, 0] } }
)";
  const Result other = run(folder(), {"render", "other.toml", "--out", "other", "--no-images", "--frames", "3",
                                      "--from", "whole", "--frame", "9", "--set", "gravity=[0,5,0]"});
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_NE(other.err.find("new here: third"), std::string::npos) << other.err;
  EXPECT_NE(profile_of(path("other"))["frames"][0]["state_hash"],
            profile_of(path("whole"))["frames"][10]["state_hash"]);
}

TEST_F(EarlierRun, RefusesByNameWhatCannotGoOn) {
  const auto told = [&](const std::vector<std::string>& more, const std::string& text) {
    const Result result = go_on("refused", more);
    EXPECT_EQ(result.status, 2) << text;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("refused"))) << text;
  };
  told({"--frame", "24"}, "has frames 0 to 23, and no frame 24");
  told({"--frame", "9", "--set", "body.bar.box.cells=[6,2,2]"}, "body 'bar' cannot go on from");
  told({"--frame", "9", "--preview"}, "a preview has other meshes");
  const Result nowhere = run(folder(), {"render", "bar.toml", "--from", "nowhere", "--out", "refused"});
  EXPECT_NE(nowhere.err.find("nowhere: no such folder"), std::string::npos) << nowhere.err;
  const Result empty = run(folder(), {"render", "bar.toml", "--from", "", "--out", "refused"});
  EXPECT_NE(empty.err.find("--from: names no folder"), std::string::npos) << empty.err;
  const Result alone = run(folder(), {"render", "bar.toml", "--frame", "3", "--out", "refused"});
  EXPECT_NE(alone.err.find("--frame requires --from"), std::string::npos) << alone.err;
  const std::string free = R"(frames = 3
[[body]]
name = "free"
box = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
)";
  std::ofstream(path("free.toml")) << free;
  ASSERT_EQ(run(folder(), {"render", "free.toml", "--out", "free", "--no-images"}).status, 0);
  std::ofstream(path("held.toml")) << free
                                   << "[[body.handles]]\nname = \"new\"\nselect = { box = [[0, 0, 0], [1, 0.1, 1]] }\n";
  const std::vector<std::string> from = {"--out", "refused", "--no-images", "--from", "free", "--frame", "1"};
  const auto render = [&](const std::string& scene) {
    std::vector<std::string> words = {"render", scene};
    words.insert(words.end(), from.begin(), from.end());
    return run(folder(), words);
  };
  const Result held = render("held.toml");
  EXPECT_NE(held.err.find("handle 'new', which it had not there"), std::string::npos) << held.err;
  std::ofstream(path("free.toml"), std::ios::app) << "density = 300\n";
  const Result changed = render("free.toml");
  EXPECT_NE(changed.err.find("density is 300 here and was"), std::string::npos) << changed.err;
  EXPECT_NE(changed.err.find("are made again, for which its scene has to be as it was"), std::string::npos)
      << changed.err;
  // The second cloth has as many vertices as the first, and other triangles.
  const std::string cloth = "[[body]]\nname = \"sheet\"\ncloth = { extent = [1, 1], stretch = 100, cells = ";
  std::ofstream(path("square.toml")) << "frames = 2\n" << cloth << "[8, 8] }\n";
  std::ofstream(path("strip.toml")) << "frames = 2\n" << cloth << "[2, 26] }\n";
  ASSERT_EQ(run(folder(), {"render", "square.toml", "--out", "square", "--no-images"}).status, 0);
  const Result other =
      run(folder(), {"render", "strip.toml", "--out", "refused", "--no-images", "--from", "square", "--frame", "1"});
  EXPECT_NE(other.err.find("body 'sheet' cannot go on from"), std::string::npos) << other.err;
  EXPECT_FALSE(std::filesystem::exists(path("refused")));
}

}  // namespace earlier_run_test
}  // namespace supple
