// Tests `supple draw`, which draws a film again from a run's saved motion.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "output/files/folder_lock.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "output/video/video.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace draw_test {

using test::read_file;
using test::Result;
using test::run;

constexpr int frames = 12;

// Holds a run of a bar that a handle turns and a cloth above a ball, whose size, label and camera a replay changes.
class DrawnRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    std::ofstream(path("two.toml")) << R"(frames = 12
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 2e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0, 1, 1]] }
keys = [{ t = 0 }, { t = 0.4, turn_deg = [0, 0, 30] }]
[[body]]
name = "sheet"
cloth = { extent = [0.4, 0.4], cells = [8, 8], stretch = 100, bend = 1 }
turn_deg = [90, 0, 0]
position = [0, 0.25, 0]
[[collider]]
name = "ball"
shape = { sphere = { radius = 0.1 } }
position = [0, 0.1, 0]
keys = [{ t = 0 }, { t = 0.4, move = [0.1, 0, 0] }]
[output]
width = 96
height = 64
samples = 4
)";
    std::ofstream(path("replay.toml")) << R"(scene = "two.toml"
[[change]]
t = 0.1
path = "collider.ball.shape.sphere.radius"
value = 0.12
[[change]]
t = 0.2
path = "body.bar.label"
value = "the bar"
[[change]]
t = 0.1
over = 0.2
path = "camera.fov_deg"
value = 40
)";
    const Result result = run(folder_->path, {"replay", "replay.toml", "--out", "run", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::filesystem::path path(const std::string& name) { return folder_->path / name; }

  static Result draw(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"draw", "run", "--out", out, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_->path, words);
  }
  static std::string picture(const std::string& folder, int frame) {
    return read_file(picture_file(path(folder) / "frames", frame));
  }
  static int pictures(const std::string& folder) {
    int count = 0;
    while (std::filesystem::exists(picture_file(path(folder) / "frames", count))) ++count;
    return count;
  }

  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> DrawnRun::folder_;

TEST_F(DrawnRun, HasTheBytesOfTheRunsPicturesAndFilm) {
  const Result result = draw("same");
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_EQ(pictures("same"), frames);
  for (int frame = 0; frame < frames; ++frame) EXPECT_EQ(picture("same", frame), picture("run", frame)) << frame;
  EXPECT_EQ(read_file(path("same") / "video.mp4"), read_file(path("run") / "video.mp4"));
}

TEST_F(DrawnRun, IsTheSameFromPartsOfSeveralProcesses) {
  ASSERT_EQ(draw("jobs", {"--jobs", "3"}).status, 0);
  for (const char* part : {"2", "0"}) ASSERT_EQ(draw("parts", {"--index", part, "--of", "3"}).status, 0);
  const Result early = draw("parts", {"--merge"});
  EXPECT_EQ(early.status, 1);
  EXPECT_NE(early.err.find("4 of 12 pictures are not drawn yet, the first of them 000004"), std::string::npos)
      << early.err;
  ASSERT_EQ(draw("parts", {"--index", "1", "--of", "3"}).status, 0);
  ASSERT_EQ(draw("parts", {"--merge"}).status, 0);
  for (const char* folder : {"jobs", "parts"}) {
    for (int frame = 0; frame < frames; ++frame) EXPECT_EQ(picture(folder, frame), picture("run", frame)) << frame;
    EXPECT_EQ(read_file(path(folder) / "video.mp4"), read_file(path("run") / "video.mp4"));
  }
  const Result other = draw("parts", {"--index", "0", "--of", "3", "--set", "look.exposure=2"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("holds another drawing"), std::string::npos) << other.err;
}

TEST_F(DrawnRun, ShowsAnotherCameraSizeAndChoiceOfFrames) {
  const Result result = draw("other", {"--set", "camera.position=[0.9, 0.5, 0.9]", "--set", "output.width=128",
                                       "--first", "2", "--last", "9", "--every", "3"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(pictures("other"), 3);
  EXPECT_EQ(read_png(picture_file(path("other") / "frames", 0)).width, 128);
  if (count_video_frames(path("run") / "video.mp4") > 0) {
    EXPECT_EQ(count_video_frames(path("other") / "video.mp4"), 3);
  }
  // A drawing may be overwritten; the rest of a longer one is removed.
  ASSERT_EQ(draw("other", {"--last", "0"}).status, 0);
  EXPECT_EQ(pictures("other"), 1);
  EXPECT_EQ(picture("other", 0), picture("run", 0));
}

TEST_F(DrawnRun, GivesOneFrameAsAPicture) {
  ASSERT_EQ(run(folder_->path, {"draw", "run", "--frame", "7", "--still", "still.png"}).status, 0);
  EXPECT_EQ(read_png(path("still.png")).rgb, read_png(picture_file(path("run") / "frames", 7)).rgb);
  const Result late = run(folder_->path, {"draw", "run", "--frame", "12"});
  EXPECT_EQ(late.status, 2);
  EXPECT_NE(late.err.find("the run's last frame is 11"), std::string::npos) << late.err;
}

TEST_F(DrawnRun, ShowsAFieldWithTheRangeOfTheWholeFilm) {
  ASSERT_EQ(draw("stretch", {"--field", "stretch"}).status, 0);
  ASSERT_EQ(draw("last", {"--field", "stretch", "--first", "11"}).status, 0);
  EXPECT_EQ(picture("last", 0), picture("stretch", 11)) << "the range depends on which frames are drawn";
  ASSERT_EQ(draw("parts-of-field", {"--field", "stretch", "--jobs", "2"}).status, 0);
  EXPECT_EQ(picture("parts-of-field", 11), picture("stretch", 11));
  ASSERT_EQ(draw("given", {"--field", "stretch", "--range", "0.5,4"}).status, 0);
  EXPECT_NE(picture("given", 11), picture("stretch", 11));
  EXPECT_NE(picture("stretch", 11), picture("run", 11));
  const Result backwards = draw("none", {"--field", "stretch", "--range", "2,1"});
  EXPECT_EQ(backwards.status, 2);
  EXPECT_NE(backwards.err.find("the first number must be below the second"), std::string::npos) << backwards.err;
}

// The field of the scene itself is drawn in the run, and again with the same bytes: speed needs the frame before, which
// of the first frame is the start.
TEST_F(DrawnRun, HasTheBytesOfARunWithAField) {
  for (const char* field : {"speed", "depth", "force"}) {
    const std::string name = std::string("run-") + field;
    ASSERT_EQ(run(folder_->path,
                  {"replay", "replay.toml", "--out", name, "--quiet", "--set", std::string("field.quantity=") + field})
                  .status,
              0);
    ASSERT_EQ(run(folder_->path, {"draw", name, "--quiet"}).status, 0);
    for (const int frame : {0, 5, 11}) EXPECT_EQ(picture(name + "-drawn", frame), picture(name, frame)) << frame;
    EXPECT_NE(picture(name, 5), picture("run", 5));
  }
}

// A run keeps what a drawing needs beyond the positions, whatever its own pictures show.
TEST_F(DrawnRun, ShowsContactForcesOfAnyRun) {
  ASSERT_EQ(draw("forces", {"--field", "force"}).status, 0);
  EXPECT_NE(picture("forces", 11), picture("run", 11));
  const std::filesystem::path kept = path("run") / "motion" / "bar.forces", aside = path("bar.forces");
  std::filesystem::rename(kept, aside);
  const Result missing = draw("without-forces", {"--field", "force"});
  std::filesystem::rename(aside, kept);
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("bar.forces: is missing, so contact forces cannot be shown"), std::string::npos)
      << missing.err;
}

// A run that goes on after a half of it was made has the graph of all of its frames.
TEST_F(DrawnRun, HasTheBytesOfARunWithAGraphOfErrors) {
  const auto film = [](const char* out, std::vector<std::string> more) {
    std::vector<std::string> words = {"replay",
                                      "replay.toml",
                                      "--out",
                                      out,
                                      "--quiet",
                                      "--set",
                                      "text.error_graph=true",
                                      "--set",
                                      "output.width=320",
                                      "--set",
                                      "output.height=180",
                                      "--error-every",
                                      "5"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_->path, words).status;
  };
  ASSERT_EQ(film("graph", {}), 0);
  ASSERT_EQ(run(folder_->path, {"draw", "graph", "--quiet"}).status, 0);
  ASSERT_EQ(film("graph-parts", {"--frames", "6"}), 0);
  ASSERT_EQ(film("graph-parts", {"--resume"}), 0);
  for (const int frame : {0, 5, 6, 11}) EXPECT_EQ(picture("graph-drawn", frame), picture("graph", frame)) << frame;
  EXPECT_EQ(picture("graph-parts", 11), picture("graph", 11));
  ASSERT_EQ(
      run(folder_->path, {"draw", "graph", "--out", "no-graph", "--quiet", "--set", "text.error_graph=false"}).status,
      0);
  EXPECT_NE(picture("no-graph", 11), picture("graph", 11));
}

// What is measured while the film is made differs from run to run, so that a drawing alone shows it as a graph.
TEST_F(DrawnRun, ShowsAGraphOfTimesThatNoRunDraws) {
  const Result refused =
      run(folder_->path, {"render", "two.toml", "--out", "no-film", "--quiet", "--set", "text.time_graph=true"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("no graph of times that are still being measured"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(path("no-film")));
  const std::vector<std::string> with = {"--set", "text.time_graph=true", "--set", "output.width=320",
                                         "--set", "output.height=180"};
  ASSERT_EQ(draw("times", with).status, 0);
  ASSERT_EQ(draw("times-again", with).status, 0);
  ASSERT_EQ(draw("no-times", {with.begin() + 2, with.end()}).status, 0);
  EXPECT_EQ(picture("times", 11), picture("times-again", 11));
  EXPECT_NE(picture("times", 11), picture("no-times", 11));
}

TEST_F(DrawnRun, ShowsTheDistanceToAnotherRun) {
  ASSERT_EQ(run(folder_->path,
                {"replay", "replay.toml", "--out", "rough", "--quiet", "--no-images", "--set", "solver.iterations=1"})
                .status,
            0);
  ASSERT_EQ(draw("far", {"--field", "distance", "--reference", "rough"}).status, 0);
  ASSERT_EQ(draw("near", {"--field", "distance", "--reference", "run"}).status, 0);
  EXPECT_NE(picture("far", 11), picture("near", 11));
  const Result missing = draw("none", {"--field", "distance"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("distance needs a reference"), std::string::npos) << missing.err;
  const Result nowhere = draw("none", {"--field", "distance", "--reference", "nowhere"});
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_FALSE(std::filesystem::exists(path("none")));
}

TEST_F(DrawnRun, IsBegunByManyProcessesAtOneTime) {
  constexpr int count = 8;
  for (int round = 0; round < 5; ++round) {
    const std::string out = "together-" + std::to_string(round);
    std::vector<std::future<Result>> results;
    for (int i = 0; i < count; ++i)
      results.push_back(std::async(std::launch::async, [&out, i] {
        return draw(out, {"--index", std::to_string(i), "--of", std::to_string(count), "--set", "output.width=32",
                          "--set", "output.height=18"});
      }));
    for (std::future<Result>& result : results) {
      const Result one = result.get();
      EXPECT_EQ(one.status, 0) << one.err;
    }
    EXPECT_EQ(pictures(out), 12);
  }
}

TEST_F(DrawnRun, KeepsAFilmWhoseNewReferenceDoesNotExist) {
  ASSERT_EQ(run(folder_->path, {"render", "two.toml", "--out", "kept", "--quiet"}).status, 0);
  const std::string before = test::read_file(path("kept") / "profile.json");
  const Result result =
      run(folder_->path, {"render", "two.toml", "--out", "kept", "--force", "--quiet", "--set", "look.ghost=nowhere"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("nowhere: no such folder"), std::string::npos) << result.err;
  EXPECT_EQ(test::read_file(path("kept") / "profile.json"), before);
  EXPECT_TRUE(std::filesystem::exists(path("kept") / "poster.png"));
}

TEST_F(DrawnRun, KnowsTheRangeOfTheFilmOnlyOnceItIsMade) {
  const Result result = run(folder_->path, {"render", "two.toml", "--out", "none", "--quiet", "--set",
                                            "field.quantity=stretch", "--set", "field.range=film"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("is known only once the film has been made"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(path("none")));
}

TEST_F(DrawnRun, BesideAnotherMayBeAPicture) {
  const Result result =
      run(folder_->path, {"draw", "run", "run", "--frame", "7", "--still", "both.png", "--layout", "row"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "  both.png\n");
  const Result film = run(folder_->path, {"draw", "run", "run", "--layout", "row", "--out", "as-film", "--quiet"});
  ASSERT_EQ(film.status, 0) << film.err;
  EXPECT_EQ(read_file(path("both.png")), picture("as-film", 7));
  for (const auto& entry : std::filesystem::directory_iterator(folder_->path))
    EXPECT_FALSE(entry.path().filename().string().starts_with("supple-still")) << entry.path();
}

TEST_F(DrawnRun, HasAReferenceOfTheSameBodies) {
  std::ofstream(path("rod.toml"))
      << "frames = 12\n[[body]]\nname = \"rod\"\nbox = { extent = [0.4, 0.1, 0.1], cells = [8, 2, "
         "2] }\nmaterial = \"jelly\"\n[output]\nwidth = 96\nheight = 64\n";
  ASSERT_EQ(run(folder_->path, {"render", "rod.toml", "--out", "rod", "--no-images", "--quiet"}).status, 0);
  const Result result = draw("none", {"--field", "distance", "--reference", "rod"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("rod: that run has no body 'bar' (it has rod), so that the two cannot be compared"),
            std::string::npos)
      << result.err;
}

TEST_F(DrawnRun, BecomesAFilmOfAnyFormat) {
  for (const auto& [format, file] : std::vector<std::pair<std::string, std::string>>{
           {"mp4-h265", "video.mp4"}, {"webm", "video.webm"}, {"webm-av1", "video.webm"}, {"gif", "video.gif"}}) {
    const Result result = draw("as-" + format, {"--format", format, "--quality", "draft"});
    ASSERT_EQ(result.status, 0) << format << ": " << result.err;
    if (count_video_frames(path("run") / "video.mp4") < 0) continue;  // there is no ffmpeg
    EXPECT_EQ(count_video_frames(path("as-" + format) / file), frames) << format;
  }
  ASSERT_EQ(draw("as-png", {"--format", "png", "--sheet"}).status, 0);
  EXPECT_EQ(picture("as-png", 7), picture("run", 7));
  EXPECT_FALSE(std::filesystem::exists(path("as-png") / "video.mp4"));
  EXPECT_GT(read_png(path("as-png") / "sheet.png").width, 96);
  EXPECT_EQ(draw("none", {"--format", "avi"}).status, 2);
}

// Colour type 6 of a PNG's header is RGB with coverage.
TEST_F(DrawnRun, HasCoverageOnATransparentBackground) {
  ASSERT_EQ(draw("clear", {"--set", "look.backdrop=transparent"}).status, 0);
  EXPECT_EQ(picture("clear", 3)[25], 6);
  EXPECT_EQ(picture("run", 3)[25], 2);
  ASSERT_EQ(draw("plain", {"--set", "look.backdrop=plain"}).status, 0);
  const PngImage plain = read_png(picture_file(path("plain") / "frames", 3));
  const auto pixel = [&plain](std::size_t i) { return std::vector(&plain.rgb[3 * i], &plain.rgb[3 * i] + 3); };
  EXPECT_EQ(pixel(0), pixel(std::size_t(plain.width) * (plain.height - 1))) << "the ground is still there";
}

TEST_F(DrawnRun, StandsBesideAnotherRun) {
  ASSERT_EQ(run(folder_->path, {"replay", "replay.toml", "--out", "other-run", "--quiet", "--no-images", "--set",
                                "solver.iterations=2", "--frames", "8"})
                .status,
            0);
  const Result result = run(
      folder_->path, {"draw", "run", "other-run", "--layout", "row", "--out", "both", "--quiet", "--format", "png"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(pictures("both"), 8) << "the film is as long as the shorter run";
  const PngImage both = read_png(picture_file(path("both") / "frames", 5));
  const PngImage left = read_png(picture_file(path("both") / "panel-1" / "frames", 5));
  EXPECT_GE(both.width, 2 * left.width);
  EXPECT_GT(both.height, left.height);
  for (int y = 0; y < left.height; ++y)
    ASSERT_TRUE(std::equal(&left.rgb[3 * std::size_t(y) * left.width],
                           &left.rgb[3 * std::size_t(y + 1) * left.width] - 3,
                           &both.rgb[3 * std::size_t(y) * both.width]));
  // With a field, the legend stands beside the panels, whose colours have one range.
  const Result field = run(folder_->path, {"draw", "run", "other-run", "--out", "both-stretched", "--quiet", "--format",
                                           "png", "--field", "stretch"});
  ASSERT_EQ(field.status, 0) << field.err;
  EXPECT_GT(read_png(picture_file(path("both-stretched") / "frames", 5)).width, both.width);
  ASSERT_EQ(draw("no-legend", {"--field", "stretch", "--set", "field.legend=false", "--set", "output.width=48", "--set",
                               "output.height=32", "--format", "png"})
                .status,
            0);
  EXPECT_EQ(picture("both-stretched/panel-1", 5), picture("no-legend", 5));
  const Result wrong = run(folder_->path, {"draw", "run", "other-run", "--jobs", "2"});
  EXPECT_EQ(wrong.status, 2);
}

TEST_F(DrawnRun, StandsBesideAnotherRunOfItsSize) {
  ASSERT_EQ(run(folder_->path, {"replay", "replay.toml", "--out", "wide-run", "--quiet", "--no-images", "--frames", "8",
                                "--set", "output.width=128"})
                .status,
            0);
  const Result apart = run(folder_->path, {"draw", "run", "wide-run", "--out", "two-sizes", "--quiet"});
  EXPECT_EQ(apart.status, 2);
  EXPECT_NE(apart.err.find("wide-run: has pictures of 128 x "), std::string::npos) << apart.err;
  EXPECT_NE(apart.err.find("--size gives all runs one size"), std::string::npos) << apart.err;
  EXPECT_FALSE(std::filesystem::exists(path("two-sizes") / "draw.json"));
  EXPECT_EQ(run(folder_->path,
                {"draw", "run", "wide-run", "--out", "two-sizes", "--quiet", "--size", "96x64", "--format", "png"})
                .status,
            0);
}

TEST_F(DrawnRun, HasTheWholeMotionInThePicture) {
  ASSERT_EQ(draw("framed", {"--set", "camera.frames=film"}).status, 0);
  EXPECT_NE(picture("framed", 5), picture("run", 5));
  ASSERT_EQ(draw("framed-last", {"--set", "camera.frames=film", "--first", "11"}).status, 0);
  EXPECT_EQ(picture("framed-last", 0), picture("framed", 11)) << "the box depends on which frames are drawn";
}

TEST_F(DrawnRun, HasTheCameraThatTheRunFoundByAFirstPass) {
  const std::vector<std::string> words = {"replay", "replay.toml",       "--out", "whole", "--quiet", "--frames", "9",
                                          "--set",  "camera.frames=film"};
  const Result made = run(folder_->path, words);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(picture("whole", 5), picture("run", 5));
  const auto framed = nlohmann::json::parse(read_file(path("whole") / "run.json"))["framed"];
  double lowest = 1;
  for (const auto& point : framed) lowest = std::min(lowest, point[1].get<double>());
  EXPECT_LT(lowest, 0.25) << "the sheet falls";
  ASSERT_EQ(run(folder_->path, {"draw", "whole", "--quiet"}).status, 0);
  for (const int frame : {0, 5, 8}) EXPECT_EQ(picture("whole-drawn", frame), picture("whole", frame)) << frame;
  // A longer film goes on with the camera of its beginning.
  const std::string before = picture("whole", 0);
  std::vector<std::string> longer = words;
  longer[6] = "12";
  longer.emplace_back("--resume");
  ASSERT_EQ(run(folder_->path, longer).status, 0);
  EXPECT_EQ(nlohmann::json::parse(read_file(path("whole") / "run.json"))["framed"], framed);
  ASSERT_EQ(run(folder_->path, {"draw", "whole", "--quiet"}).status, 0);
  for (const int frame : {0, 11}) EXPECT_EQ(picture("whole-drawn", frame), picture("whole", frame)) << frame;
  EXPECT_EQ(picture("whole", 0), before);
}

// The scene has no table [output], so that the setting adds one.
TEST_F(DrawnRun, MayHaveASizeOfWhichTheSceneSaysNothing) {
  std::ofstream(path("bare.toml")) << "frames = 1\n[[body]]\nbox = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }\n"
                                      "material = \"rubber\"\n";
  ASSERT_EQ(run(folder_->path, {"render", "bare.toml", "--out", "bare", "--quiet", "--no-images"}).status, 0);
  const Result result = run(folder_->path, {"draw", "bare", "--frame", "0", "--still", "bare.png", "--set",
                                            "output.width=64", "--set", "output.height=48"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(read_png(path("bare.png")).width, 64);
}

TEST_F(DrawnRun, ShowsTheGhostOfAnotherRun) {
  ASSERT_EQ(run(folder_->path, {"replay", "replay.toml", "--out", "ghost-run", "--quiet", "--no-images", "--set",
                                "solver.iterations=1"})
                .status,
            0);
  ASSERT_EQ(draw("with-ghost", {"--set", "look.ghost=ghost-run"}).status, 0);
  EXPECT_NE(picture("with-ghost", 11), picture("run", 11));
  ASSERT_EQ(draw("own-ghost", {"--set", "look.ghost=run"}).status, 0);
  EXPECT_EQ(picture("own-ghost", 0), picture("run", 0)) << "a ghost in the same place is hidden";
  EXPECT_EQ(draw("none", {"--set", "look.ghost=nowhere"}).status, 2);
  const Result plain = draw("none", {"--set", "look.ghost=run", "--set", "output.samples=1"});
  EXPECT_EQ(plain.status, 2);
  EXPECT_NE(plain.err.find("output.samples must be 2 or more"), std::string::npos) << plain.err;
  ASSERT_EQ(
      run(folder_->path, {"replay", "replay.toml", "--out", "short-run", "--quiet", "--no-images", "--frames", "8"})
          .status,
      0);
  const Result short_of = draw("none", {"--set", "look.ghost=short-run"});
  EXPECT_EQ(short_of.status, 2);
  EXPECT_NE(short_of.err.find("has 8 frames, and frame 11 is needed"), std::string::npos) << short_of.err;
}

TEST_F(DrawnRun, RefusesWhatWouldHaveMovedOtherwise) {
  const Result material = draw("none", {"--set", "body.bar.material.mu=1e4"});
  EXPECT_EQ(material.status, 2);
  EXPECT_NE(material.err.find("body.bar.material.mu is 10000.0 here and was 20000.0 in the run"), std::string::npos)
      << material.err;
  EXPECT_NE(material.err.find("(title, camera, look, field, text, output's size,"), std::string::npos) << material.err;
  const Result mesh = draw("none", {"--set", "body.bar.box.cells=[9, 2, 2]"});
  EXPECT_EQ(mesh.status, 2);
  EXPECT_FALSE(std::filesystem::exists(path("none")));

  std::string text = read_file(path("replay.toml"));
  std::ofstream(path("sooner.toml")) << text.replace(text.find("t = 0.1"), 7, "t = 0.0");
  const Result replay = draw("none", {"--scene", "sooner.toml"});
  EXPECT_EQ(replay.status, 2);
  EXPECT_NE(replay.err.find("the replay changes other values"), std::string::npos) << replay.err;
  const Result gone = draw("none", {"--scene", "nowhere.toml"});
  EXPECT_EQ(gone.status, 2);
  EXPECT_NE(gone.err.find("nowhere.toml: the run's scene is no longer there"), std::string::npos) << gone.err;
}

TEST_F(DrawnRun, TakesAnotherCameraFromACopyOfTheReplay) {
  std::string text = read_file(path("replay.toml"));
  std::ofstream(path("wider.toml")) << text.replace(text.find("value = 40"), 10, "value = 60");
  ASSERT_EQ(draw("wider", {"--scene", "wider.toml"}).status, 0);
  EXPECT_EQ(picture("wider", 0), picture("run", 0));
  EXPECT_NE(picture("wider", 11), picture("run", 11));
}

TEST_F(DrawnRun, IsNotDisturbedByAnotherDrawingIntoItsFolder) {
  ASSERT_EQ(draw("busy", {"--index", "0", "--of", "2"}).status, 0);
  const auto refused = [](const Result& result) {
    return result.status == 2 && result.err.find("another run writes into this folder now") != std::string::npos;
  };
  FolderLock other(path("busy"));  // as a drawing of the whole film holds it
  for (const std::vector<std::string>& how :
       std::vector<std::vector<std::string>>{{}, {"--jobs", "2"}, {"--index", "1", "--of", "2"}, {"--merge"}})
    EXPECT_TRUE(refused(draw("busy", how)));
  EXPECT_TRUE(refused(run(folder_->path, {"draw", "run", "run", "--out", "busy", "--quiet"})));
  other.share();  // as one that draws a part
  EXPECT_TRUE(refused(draw("busy")));
  EXPECT_EQ(pictures("busy"), frames / 2);
  EXPECT_EQ(draw("busy", {"--index", "1", "--of", "2"}).status, 0);
  EXPECT_EQ(draw("busy", {"--merge"}).status, 0);
  EXPECT_EQ(pictures("busy"), frames);
}

TEST_F(DrawnRun, KeepsOtherFoldersAsTheyAre) {
  std::filesystem::create_directories(path("mine"));
  std::ofstream(path("mine") / "letter.txt") << "dear";
  const Result result = draw("mine");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("holds files that no drawing left there"), std::string::npos) << result.err;
  EXPECT_EQ(draw("run").status, 2);
  EXPECT_EQ(pictures("run"), frames);
}

}  // namespace draw_test
}  // namespace supple
