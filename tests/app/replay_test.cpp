// Tests films that change while they run, and films that were killed: every run must give the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "output/video.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace {

using test::read_file;
using test::Result;
using test::run;

// Films a bar and a cloth, which are changed in every way, at a small size.
class ReplayedFilm : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "two.toml") << R"(frames = 24
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [10, 3, 3] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
keys = [{ t = 0 }, { t = 0.4, move = [0, 0.1, 0] }, { t = 0.8 }]
[[body]]
name = "sheet"
cloth = { extent = [0.4, 0.4], cells = [10, 10], stretch = 100, bend = 1 }
turn_deg = [90, 0, 0]
position = [0, 0.25, 0]
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, 0.1, 0]
[output]
width = 96
height = 64
samples = 1
)";
    std::ofstream(folder_.path / "r.toml") << R"(scene = "two.toml"
[[grab]]
body = "bar"
name = "fingers"
select = { box = [[0.9, 0, 0], [1, 1, 1]] }
stiffness = 30
from = 0.1
until = 0.5
keys = [{ t = 0.1 }, { t = 0.4, move = [0.05, 0.1, 0], turn_deg = [20, 0, 0] }]
[[change]]
t = 0.2
over = 0.3
by = "ratio"
path = "body.bar.material.mu"
value = 2e5
[[change]]
t = 0.3
path = "body.sheet.cloth.stretch"
value = 300
[[change]]
t = 0.3
over = 0.2
path = "collider.ball.shape.sphere.radius"
value = 0.14
[[change]]
t = 0.1
over = 0.4
path = "collider.ball.position"
value = [0.05, 0.1, 0.02]
[[change]]
frame = 12
path = "substeps"
value = 2
[[change]]
frame = 16
path = "body.bar.solver.method"
value = "newton"
[[change]]
frame = 18
path = "body.bar.solver.integrator"
value = "implicit-midpoint"
[[change]]
frame = 9
path = "body.bar.label"
value = "pulled"
[[change]]
t = 0.1
over = 0.5
path = "camera.margin"
value = 1.6
)";
  }

  std::vector<std::string> film(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"replay", "r.toml", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::vector<std::string> hashes(const std::string& out) const {
    std::vector<std::string> list;
    const auto profile = test::profile_of(folder_.path / out);
    for (const auto& frame : profile["frames"]) list.push_back(frame["state_hash"]);
    return list;
  }
  std::vector<std::string> pictures(const std::string& out) const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path / out / "frames")) files.push_back(entry);
    std::sort(files.begin(), files.end());
    std::vector<std::string> contents;
    for (const std::filesystem::path& file : files) contents.push_back(read_file(file));
    return contents;
  }
  // Compares everything that a film consists of, except for times.
  void expect_the_same_film(const std::string& a, const std::string& b) const {
    EXPECT_EQ(hashes(a), hashes(b));
    EXPECT_EQ(pictures(a), pictures(b));
    for (const char* file : {"motion/bar.pc2", "motion/sheet.pc2", "motion/colliders.csv"})
      EXPECT_EQ(read_file(folder_.path / a / file), read_file(folder_.path / b / file)) << file;
    if (std::filesystem::exists(folder_.path / a / "video.mp4")) {
      EXPECT_EQ(count_video_frames(folder_.path / b / "video.mp4"), long(hashes(b).size()));
      EXPECT_EQ(read_file(folder_.path / b / "video.mp4"), read_file(folder_.path / a / "video.mp4"));
    }
  }

  test::TemporaryFolder folder_;
};

TEST_F(ReplayedFilm, GivesTheSameBitsForAnyThreadsWithAndWithoutImages) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--threads", "1", "--out", "a"})).status, 0);
  const std::vector<std::string> expected = hashes("a");
  ASSERT_EQ(expected.size(), 24u);
  for (const char* threads : {"1", "2", "4"}) {
    ASSERT_EQ(run(folder_.path, film({"--no-video", "--threads", threads, "--out", "b"})).status, 0);
    EXPECT_EQ(hashes("b"), expected);
  }
  ASSERT_EQ(run(folder_.path, {"render", "two.toml", "--no-images", "--quiet", "--out", "plain"}).status, 0);
  const std::vector<std::string> plain = hashes("plain");
  EXPECT_TRUE(std::equal(plain.begin(), plain.begin() + 3, expected.begin()));  // the grab is at 0.1 s
  EXPECT_NE(plain[3], expected[3]);
}

TEST_F(ReplayedFilm, IsVerifiedVertexByVertex) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--record", "film.rec"})).status, 0);
  const Result same = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--threads", "1"}));
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_EQ(same.out, "  verified: frames 0 to 23 are the same to the last bit\n");

  // The replay now differs in the last bit of one number: 2e5 and the next double.
  std::string text = read_file(folder_.path / "r.toml");
  text.replace(text.find("value = 2e5"), 11, "value = 200000.00000000003");
  std::ofstream(folder_.path / "r.toml") << text;
  const Result other = run(folder_.path, film({"--no-images", "--verify", "film.rec"}));
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.err.find("not the film that was recorded"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("replay.change"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("body 'bar' is not what was recorded; vertex "), std::string::npos) << other.err;
  const std::size_t named = other.err.find("supple: frame ");
  ASSERT_NE(named, std::string::npos);
  const int frame = std::atoi(other.err.c_str() + named + 14);
  EXPECT_GE(frame, 6);  // 0.2 s
  EXPECT_LE(frame, 14);
  const Result near = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--tolerance", "1e-4"}));
  EXPECT_EQ(near.status, 0) << near.err;
  EXPECT_NE(near.out.find("frames 0 to 23 are within 0.0001"), std::string::npos) << near.out;

  std::string record = read_file(folder_.path / "film.rec");
  record.replace(record.find("\"program\":\"") + 11, 4, "0000");
  std::ofstream(folder_.path / "film.rec", std::ios::binary) << record;
  const Result cut = run(folder_.path, film({"--no-images", "--verify", "film.rec", "--record", "film.rec"}));
  EXPECT_EQ(cut.status, 2);
  EXPECT_NE(cut.err.find("would be overwritten"), std::string::npos) << cut.err;
  const Result foreign = run(folder_.path, film({"--no-images", "--verify", "film.rec"}));
  EXPECT_EQ(foreign.status, 2);
  EXPECT_NE(foreign.err.find("was recorded by another build"), std::string::npos) << foreign.err;
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--verify", "two.toml"})).status, 2);
}

TEST_F(ReplayedFilm, GoesOnAfterBeingKilledAsIfNothingHadHappened) {
  ASSERT_EQ(run(folder_.path, film({"--out", "whole"})).status, 0);
  std::mt19937 dice(5);
  int kills = 0;
  for (int attempt = 0; attempt < 6; ++attempt) {
    std::filesystem::remove_all(folder_.path / "cut");
    std::vector<std::string> arguments = film({"--out", "cut", "--checkpoint-every", "1"});
    // Four times the run is killed after a picture in the middle of the film exists, so that it is certain to be
    // running; otherwise it is killed at any time.
    const std::filesystem::path picture = folder_.path / "cut" / "frames" / fmt::format("{:06}.png", dice() % 16);
    Result result = attempt < 4 ? run(folder_.path, arguments, picture, SIGKILL)
                                : test::run_and_kill(folder_.path, arguments, int(dice() % 900));
    kills += result.status < 0;
    arguments.push_back("--resume");
    if (attempt % 2 == 0 && std::filesystem::exists(folder_.path / "cut" / "run.json"))  // and once more
      kills += test::run_and_kill(folder_.path, arguments, int(dice() % 900)).status < 0;
    result = run(folder_.path, arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    expect_the_same_film("whole", "cut");
  }
  EXPECT_GE(kills, 4);
}

TEST_F(ReplayedFilm, GoesOnAfterAnInterruptAndMayBecomeLonger) {
  ASSERT_EQ(run(folder_.path, film({"--out", "whole", "--frames", "30"})).status, 0);
  const Result cut = run(folder_.path, film({"--out", "cut"}), folder_.path / "cut" / "frames" / "000004.png");
  ASSERT_EQ(cut.status, 130) << cut.err;
  const Result on = run(folder_.path, film({"--out", "cut", "--resume"}));
  ASSERT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find("note: resuming after frame "), std::string::npos) << on.err;
  EXPECT_EQ(hashes("cut").size(), 24u);
  ASSERT_EQ(run(folder_.path, film({"--out", "cut", "--resume", "--frames", "30"})).status, 0);
  expect_the_same_film("whole", "cut");
  EXPECT_EQ(run(folder_.path, film({"--out", "cut", "--resume", "--frames", "20"})).status, 2);
}

TEST_F(ReplayedFilm, RefusesTheCheckpointOfAnotherFilm) {
  ASSERT_EQ(run(folder_.path, film({"--out", "a", "--no-images"})).status, 0);
  const auto refused = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--out", "a", "--resume"});
    const Result result = run(folder_.path, film(more));
    EXPECT_EQ(result.status, 2) << result.err;
    return result.err;
  };
  EXPECT_NE(refused({"--no-images", "--set", "body.bar.density=900"}).find("scene.body.bar.density: nothing and 900"),
            std::string::npos);
  EXPECT_NE(refused({}).find("images: false and true"), std::string::npos);
  EXPECT_NE(refused({"--no-images", "--vtu", "4"}).find("vtu: 0 and 4"), std::string::npos);
  EXPECT_NE(refused({"--no-images", "--frames", "30", "--save-state", "23"}).find("goes on with frame 24"),
            std::string::npos);
  EXPECT_EQ(hashes("a").size(), 24u);  // nothing of it was lost
  std::string bytes = read_file(folder_.path / "a" / "checkpoint" / "state");
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(folder_.path / "a" / "checkpoint" / "state", std::ios::binary) << bytes;
  EXPECT_NE(refused({"--no-images"}).find("is damaged"), std::string::npos);
}

// Returns two tetrahedra with a region each.
std::string two_regions(int first, int second) {
  return fmt::format(
      "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
      "Tetrahedra\n2\n1 2 3 4 {}\n2 5 3 4 {}\nEnd\n",
      first, second);
}

TEST_F(ReplayedFilm, RefusesTheCheckpointOfOtherFiles) {
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder_.path / name) << text; };
  const std::string ball = "[[part]]\nsphere = { radius = 0.1 }\n";
  write("ball.toml", ball);
  write("later.toml", ball);
  write("last.toml", ball);
  write("two.mesh", two_regions(1, 2));
  write("files.toml", R"(frames = 6
[[body]]
name = "solid"
mesh = "two.mesh"
material = "rubber"
position = [0, 2, 0]
[body.regions.1]
material = "jelly"
[[collider]]
name = "ball"
shape = "ball.toml"
)");
  const std::string change = "[[change]]\npath = \"collider.ball.shape\"\n";
  write("r.toml", "scene = \"files.toml\"\n" + change + "frame = 3\nvalue = \"later.toml\"\n" + change +
                      "frame = 8\nvalue = \"last.toml\"\n");
  const auto resumed = [&] { return run(folder_.path, film({"--no-images", "--out", "a", "--resume"})); };
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a"})).status, 0);
  write("ball.toml", "# the same ball\n" + ball);
  EXPECT_EQ(resumed().status, 0);
  const auto expect_refused = [&](const char* name, const std::string& text) {
    const std::string before = read_file(folder_.path / name);
    write(name, text);
    const Result result = resumed();
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(fmt::format("files.{}.xxh64: ", name)), std::string::npos) << result.err;
    write(name, before);
    EXPECT_EQ(resumed().status, 0) << name;
  };
  expect_refused("ball.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  expect_refused("later.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  expect_refused("two.mesh", two_regions(2, 1));
  expect_refused("last.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "12"})).status, 0);
}

TEST_F(ReplayedFilm, StartsAnewWhereThereIsNoCheckpointYet) {
  const Result result = run(folder_.path, film({"--out", "a", "--no-images", "--resume"}));
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("has no checkpoint yet"), std::string::npos) << result.err;
}

TEST_F(ReplayedFilm, LeavesAFilmWithoutACheckpointAloneUnlessItsRunWasCutShort) {
  const auto filmed = [this](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "two.toml", "--no-images", "--quiet", "--checkpoint-every", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path, words);
  };
  ASSERT_EQ(filmed({"--out", "a"}).status, 0);
  const Result complete = filmed({"--out", "a", "--resume"});
  EXPECT_EQ(complete.status, 2);
  EXPECT_NE(complete.err.find("a holds a film that is complete, of 24 frames"), std::string::npos) << complete.err;
  EXPECT_NE(complete.err.find("without --resume it is made anew"), std::string::npos) << complete.err;
  EXPECT_EQ(hashes("a").size(), 24u);

  const std::filesystem::path file = folder_.path / "a" / "run.json";
  std::string text = read_file(file);
  text.replace(text.find("\"done\""), 6, "\"running\"");  // as a run that was killed leaves it
  std::ofstream(file) << text;
  const Result other = filmed({"--out", "a", "--resume", "--set", "body.bar.density=900"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("scene.body.bar.density: nothing and 900"), std::string::npos) << other.err;
  EXPECT_EQ(hashes("a").size(), 24u);
  const Result same = filmed({"--out", "a", "--resume", "--frames", "4"});
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_EQ(hashes("a").size(), 4u);
}

TEST_F(ReplayedFilm, GoesOnBehindTheLastWholeFrameOfARunThatFailed) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--record", "film.rec"})).status, 0);
  std::string text = read_file(folder_.path / "r.toml");
  text.replace(text.find("value = 2e5"), 11, "value = 3e5");
  std::ofstream(folder_.path / "r.toml") << text;
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "whole"})).status, 0);
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "cut", "--verify", "film.rec"})).status, 1);
  const std::size_t kept = hashes("cut").size();
  EXPECT_GE(kept, 6u);  // the change is at 0.2 s
  const Result on = run(folder_.path, film({"--no-images", "--out", "cut", "--resume"}));
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find(fmt::format("note: resuming after frame {} of 24", kept)), std::string::npos) << on.err;
  expect_the_same_film("whole", "cut");
}

TEST_F(ReplayedFilm, RefusesToGoOnBehindFilesThatWereCutAndTouchesNothing) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a"})).status, 0);
  for (const char* name : {"motion/colliders.csv", "motion/sheet.pc2", "checkpoint/rows.jsonl"}) {
    const std::filesystem::path file = folder_.path / "a" / name;
    const std::string whole = read_file(file);
    std::filesystem::resize_file(file, 100);
    const Result result = run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "26"}));
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(std::string("a/") + name + ": "), std::string::npos) << result.err;
    EXPECT_EQ(std::filesystem::file_size(file), 100u);
    EXPECT_EQ(hashes("a").size(), 24u);
    std::ofstream(file, std::ios::binary) << whole;
  }
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "26"})).status, 0);
}

TEST_F(ReplayedFilm, GoesOnBehindStatesThatWereSavedUnlessTheyAreGone) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--frames", "6", "--save-state", "2"})).status, 0);
  EXPECT_EQ(
      run(folder_.path, film({"--no-images", "--out", "a", "--frames", "9", "--resume", "--save-state", "2,7"})).status,
      0);
  std::filesystem::remove_all(folder_.path / "a" / "states" / "bar-000002");
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--save-state", "2"})).status, 2);
}

TEST_F(ReplayedFilm, StartsAnewInAFolderThatARunHadOnlyBegunToTake) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--frames", "6"})).status, 0);
  std::ofstream(folder_.path / "a" / "run.json") << "{}\n";  // another run's first act
  const Result result =
      run(folder_.path, {"render", "two.toml", "--no-images", "--frames", "3", "--out", "a", "--resume"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(hashes("a").size(), 3u);
}

TEST_F(ReplayedFilm, RefusesSpringsThatWouldComeOrGo) {
  for (const char* change :
       {"path = \"body.sheet.cloth.bend\"\nvalue = 0", "path = \"body.sheet.cloth.shear\"\nvalue = 0"}) {
    std::ofstream(folder_.path / "bad.toml") << "scene = \"two.toml\"\n[[change]]\nt = 0.3\nover = 0.2\n"
                                             << change << "\n";
    const Result result = run(folder_.path, {"replay", "bad.toml", "--no-images"});
    EXPECT_EQ(result.status, 2) << change;
    EXPECT_NE(result.err.find("cannot reach or leave 0"), std::string::npos) << result.err;
  }
}

TEST_F(ReplayedFilm, ListsAllThatTheBodiesRefuse) {
  std::ofstream(folder_.path / "bad.toml") << R"(scene = "two.toml"
[[change]]
t = 0.3
path = "body.bar.handles.end.stiffness"
value = 30
[[change]]
t = 0.2
path = "body.sheet.cloth.bend"
value = 0
[[change]]
t = 0.4
path = "body.sheet.cloth.stretch"
value = 200
)";
  const Result result = run(folder_.path, {"check", "bad.toml"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "bad.toml:9:9: shear and bend of the cloth of body 'sheet' cannot reach or leave 0 while the film runs\n"
            "bad.toml:5:9: handle 'end' of body 'bar': hard handles stay hard, and springs stay springs\n");
}

TEST_F(ReplayedFilm, AWholeSolverTableTakesEffectAtOnce) {
  const auto film_with = [&](const std::string& changes) {
    std::ofstream(folder_.path / "s.toml") << "scene = \"two.toml\"\nframes = 10\n" << changes;
    EXPECT_EQ(run(folder_.path, {"replay", "s.toml", "--no-images", "--quiet", "--out", "s"}).status, 0);
    return hashes("s");
  };
  const std::string at = "[[change]]\nframe = 4\npath = \"body.bar.solver";
  EXPECT_EQ(film_with(at + "\"\nvalue = { method = \"newton\", damping = 0.01 }\n"),
            film_with(at + ".method\"\nvalue = \"newton\"\n" + at + ".damping\"\nvalue = 0.01\n"));
}

TEST_F(ReplayedFilm, ACaptionChangesFromItsFrameOn) {
  std::ofstream(folder_.path / "s.toml") << R"(scene = "two.toml"
frames = 6
[[change]]
frame = 2
path = "body.bar.label"
value = "pulled"
[[change]]
frame = 4
path = "body.bar.label"
value = "bar"
)";
  ASSERT_EQ(run(folder_.path, {"replay", "s.toml", "--no-video", "--quiet", "--out", "s"}).status, 0);
  ASSERT_EQ(run(folder_.path, {"render", "two.toml", "--frames", "6", "--no-video", "--quiet", "--out", "p"}).status,
            0);
  EXPECT_EQ(hashes("s"), hashes("p"));
  const std::vector<std::string> changed = pictures("s"), plain = pictures("p");
  for (const std::size_t frame : {0, 1, 4, 5}) EXPECT_EQ(changed[frame], plain[frame]) << frame;
  for (const std::size_t frame : {2, 3}) EXPECT_NE(changed[frame], plain[frame]) << frame;
}

TEST_F(ReplayedFilm, TellsOfImpossibleChangesBeforeTheFilmBegins) {
  std::ofstream(folder_.path / "bad.toml") << R"(scene = "two.toml"
[[change]]
t = 0.3
path = "body.bar.handles.end.stiffness"
value = 30
)";
  const Result result = run(folder_.path, {"replay", "bad.toml", "--no-images"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("hard handles stay hard"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "out"));
}

}  // namespace
}  // namespace supple
