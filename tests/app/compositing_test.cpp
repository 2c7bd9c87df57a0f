// Tests what a film gives to programs for compositing: transparent films, the shadows on their ground, and passes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "output/files/child_program.h"
#include "output/files/exr_file.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "output/video/video.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace compositing_test {

using test::read_file;
using test::Result;
using test::run;

constexpr int width = 160, height = 96, frames = 8;

class CompositedFilm : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "box.toml") << R"(frames = 8
[[body]]
name = "box"
box = { extent = [0.4, 0.4, 0.4], cells = [3, 3, 3] }
position = [0, 0.1, 0]
turn_deg = [0, 30, 0]
velocity = [1, 0, 0]
material = "jelly"
color = [0.9, 0.35, 0.05]
[[body]]
name = "small"
box = { extent = [0.2, 0.2, 0.2], cells = [2, 2, 2] }
position = [-0.5, 0.3, 0.3]
material = "jelly"
color = "#3b5b8c"
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
[look]
labels = false
[output]
width = 160
height = 96
)";
  }

  Result film(const std::string& out, std::vector<std::string> more = {}, const std::filesystem::path& signal_when = {},
              int signal = SIGINT) const {
    more.insert(more.begin(), {"render", "box.toml", "--quiet", "--out", out});
    return run(folder_.path, more, signal_when, signal);
  }
  Result draw(const std::string& out, std::vector<std::string> more) const {
    more.insert(more.begin(), {"draw", "run", "--quiet", "--out", out});
    return run(folder_.path, more);
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path / name; }

  // Returns the content of every file in a folder, by its path there.
  std::map<std::string, std::string> files_in(const std::string& folder) const {
    std::map<std::string, std::string> files;
    std::error_code none;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(folder), none))
      if (entry.is_regular_file()) files[entry.path().lexically_relative(path(folder))] = read_file(entry.path());
    return files;
  }

  // Lays a film over a picture with ffmpeg. Returns red, green and blue of all frames; empty where that fails.
  std::string laid_over(const std::string& picture, const std::filesystem::path& film) const {
    std::vector<std::string> words = {"ffmpeg", "-v",         "error", "-y", "-loop",
                                      "1",      "-framerate", "30",    "-i", file_word(path(picture))};
    // ffmpeg's own decoder of VP9 leaves the coverage out.
    if (film.extension() == ".webm") words.insert(words.end(), {"-c:v", "libvpx-vp9"});
    // A WebM tells times in whole milliseconds, between which the picture's frames would fall.
    words.insert(words.end(), {"-r", "30", "-i", file_word(film), "-filter_complex",
                               "[1]scale=flags=accurate_rnd+full_chroma_int,"
                               "format=gbrap[film];[0][film]overlay=shortest=1:format=gbrp,format=rgb24",
                               "-f", "rawvideo", file_word(path("laid.raw"))});
    const auto end = run_program(words);
    if (!end || end->status != 0) return "";
    return read_file(path("laid.raw"));
  }

  test::TemporaryFolder folder_;
};

bool has_ffmpeg() {
  const auto told = run_program({"ffmpeg", "-version"});
  return told && told->status == 0;
}

// Returns a chessboard of two colours.
std::vector<std::uint8_t> chessboard() {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if ((x / 12 + y / 12) % 2 == 0) {
        rgb.insert(rgb.end(), {230, 240, 225});
      } else {
        rgb.insert(rgb.end(), {40, 90, 60});
      }
    }
  }
  return rgb;
}

struct Difference {
  double mean = 0;
  int largest = 0;
};

// Compares the frames of a film over a picture with the run's own pictures over it. border: pixels that are covered in
// part count, too.
Difference difference(const std::string& laid, const std::filesystem::path& pictures,
                      const std::vector<std::uint8_t>& back, bool border) {
  Difference result;
  long count = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const PngImage picture = read_png_with_coverage(picture_file(pictures, frame));
    for (std::size_t i = 0; i < back.size(); ++i) {
      const double share = picture.alpha[i / 3] / 255.0;
      if (!border && share > 0 && share < 1) continue;
      const double expected = share * picture.rgb[i] + (1 - share) * back[i];
      const double off = std::abs(expected - static_cast<std::uint8_t>(laid[std::size_t(frame) * back.size() + i]));
      result.mean += off;
      result.largest = std::max(result.largest, static_cast<int>(std::lround(off)));
      ++count;
    }
  }
  result.mean /= double(count);
  return result;
}

TEST_F(CompositedFilm, LaidOverAChessboardIsItsPicturesLaidOverIt) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::vector<std::uint8_t> back = chessboard();
  write_png(path("board.png"), width, height, back);
  for (const char* backdrop : {"transparent", "shadows"}) {
    ASSERT_EQ(film("run", {"--force", "--set", fmt::format("look.backdrop={}", backdrop)}).status, 0);
    for (const std::string format : {"mov", "webm", "gif"}) {
      ASSERT_EQ(draw(format, {"--format", format, "--quality", "best"}).status, 0);
      const std::string laid = laid_over("board.png", path(format) / ("video." + format));
      ASSERT_EQ(laid.size(), std::size_t(frames) * back.size()) << format;
      const bool whole = format == "gif";  // its pixels are covered or not
      const Difference off = difference(laid, path("run") / "frames", back, !whole);
      RecordProperty(fmt::format("{}_{}_mean", backdrop, format), fmt::format("{:.3f}", off.mean));
      RecordProperty(fmt::format("{}_{}_largest", backdrop, format), off.largest);
      EXPECT_LE(off.mean, 1) << format << " " << backdrop;
      if (format == "mov") {
        EXPECT_LE(off.largest, 3) << backdrop;
      }
    }
  }
}

TEST_F(CompositedFilm, BecomesAWebmUnlessAnotherFormatIsAskedFor) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_EQ(film("run", {"--set", "look.backdrop=transparent"}).status, 0);
  EXPECT_EQ(count_video_frames(path("run") / "video.webm"), frames);
  EXPECT_FALSE(std::filesystem::exists(path("run") / "video.mp4"));
  for (const char* format : {"mp4", "mp4-h265", "webm-av1"}) {
    const std::string message = fmt::format(
        "--format {}: a film of this format cannot be transparent, as look.backdrop = \"shadows\" asks for: "
        "allowed are webm, mov, gif, png\n",
        format);
    const Result drawn = draw("none", {"--format", format, "--set", "look.backdrop=shadows"});
    EXPECT_EQ(drawn.status, 2);
    EXPECT_EQ(drawn.err, message);
    const Result rendered = film("none", {"--format", format, "--set", "look.backdrop=shadows"});
    EXPECT_EQ(rendered.status, 2);
    EXPECT_EQ(rendered.err, message);
    EXPECT_FALSE(std::filesystem::exists(path("none")));
  }
  EXPECT_EQ(draw("opaque", {"--format", "mov", "--set", "look.backdrop=ground"}).status, 0);
  EXPECT_EQ(count_video_frames(path("opaque") / "video.mov"), frames);
}

TEST_F(CompositedFilm, TransparentOnesHaveTheSameBytesAfterAnInterrupt) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::vector<std::string> clear = {"--set", "look.backdrop=shadows", "--format", "mov"};
  ASSERT_EQ(film("run", clear).status, 0);
  std::vector<std::string> words = clear;
  words.insert(words.end(), {"--checkpoint-every", "1"});
  film("cut", words, path("cut") / "frames" / "000003.png");
  words.emplace_back("--resume");
  ASSERT_EQ(film("cut", words).status, 0);
  EXPECT_EQ(files_in("cut/frames"), files_in("run/frames"));
  EXPECT_EQ(read_file(path("cut") / "video.mov"), read_file(path("run") / "video.mov"));
}

const std::string every_pass = "depth,normals,masks,motion,positions";

TEST_F(CompositedFilm, PassesAreTheSameHoweverTheyAreMade) {
  if (!writes_exr()) GTEST_SKIP() << "the program was built without OpenEXR";
  ASSERT_EQ(film("run", {"--passes", every_pass, "--threads", "1"}).status, 0);
  const std::map<std::string, std::string> passes = files_in("run/passes");
  EXPECT_EQ(passes.size(), std::size_t(6 * frames));
  EXPECT_EQ(passes.count("masks/small/000003.exr"), 1U);
  ASSERT_EQ(film("threads", {"--passes", every_pass, "--threads", "3"}).status, 0);
  EXPECT_EQ(files_in("threads/passes"), passes);
  ASSERT_EQ(draw("drawn", {}).status, 0);
  EXPECT_EQ(files_in("drawn/passes"), passes);
  ASSERT_EQ(draw("parts", {"--jobs", "3"}).status, 0);
  EXPECT_EQ(files_in("parts/passes"), passes);
  ASSERT_EQ(film("bare", {"--passes", "masks", "--film-only"}).status, 0);
  EXPECT_EQ(files_in("bare/passes").size(), std::size_t(2 * frames));
  EXPECT_TRUE(files_in("bare/frames").empty());
}

TEST_F(CompositedFilm, PassesAreTheSameAfterAnInterruptAndInALongerFilm) {
  if (!writes_exr()) GTEST_SKIP() << "the program was built without OpenEXR";
  ASSERT_EQ(film("run", {"--passes", every_pass, "--frames", "12"}).status, 0);
  std::vector<std::string> words = {"--passes", every_pass, "--checkpoint-every", "1"};
  film("cut", words, path("cut") / "passes" / "motion" / "000003.exr");
  words.emplace_back("--resume");
  ASSERT_EQ(film("cut", words).status, 0);
  EXPECT_NE(files_in("cut/passes"), files_in("run/passes"));
  words.insert(words.end(), {"--frames", "12"});
  ASSERT_EQ(film("cut", words).status, 0);
  EXPECT_EQ(files_in("cut/passes"), files_in("run/passes"));
  EXPECT_EQ(files_in("cut/frames"), files_in("run/frames"));
  std::filesystem::remove(path("cut") / "passes" / "depth" / "000002.exr");
  const Result missed = film("cut", {"--passes", every_pass, "--resume", "--frames", "13"});
  EXPECT_EQ(missed.status, 2);
  EXPECT_NE(missed.err.find("passes/depth/000002.exr: is missing"), std::string::npos) << missed.err;
}

TEST_F(CompositedFilm, PassesCostNothingWhereNobodyAsksForThem) {
  ASSERT_EQ(film("run").status, 0);
  EXPECT_FALSE(std::filesystem::exists(path("run") / "passes"));
  const Result still = run(folder_.path, {"draw", "run", "--passes", "depth", "--frame", "2"});
  EXPECT_EQ(still.status, 2);
  EXPECT_EQ(draw("none", {"--passes", "beauty"}).status, 2);
  const Result wrong = film("none", {"--set", "output.passes=[\"depth\", \"z\"]"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("depth, normals, masks, motion or positions"), std::string::npos) << wrong.err;
  if (!writes_exr()) {
    EXPECT_NE(film("none", {"--passes", "depth"}).err.find("libopenexr-dev"), std::string::npos);
    return;
  }
  const auto before = files_in("run/frames");
  ASSERT_EQ(draw("with", {"--passes", "depth"}).status, 0);
  EXPECT_EQ(files_in("with/frames"), before);
  EXPECT_EQ(files_in("with/passes").size(), std::size_t(frames));
  ASSERT_EQ(draw("with", {}).status, 0);
  EXPECT_TRUE(files_in("with/passes").empty()) << "those of the earlier drawing are gone";
}

// Returns the commands of a manual page's section that call ffmpeg, each in one line.
std::vector<std::string> commands_of(const std::string& page, const std::string& section) {
  std::istringstream lines(page.substr(page.find("\n## " + section + "\n") + 1));
  std::vector<std::string> commands;
  bool goes_on = false;
  std::getline(lines, commands.emplace_back());  // the heading
  commands.clear();
  for (std::string line; std::getline(lines, line) && !line.starts_with("## ");) {
    if (!goes_on && !line.starts_with("ffmpeg ")) continue;
    if (!goes_on) commands.emplace_back();
    goes_on = line.ends_with('\\');
    if (goes_on) line.pop_back();
    commands.back() += line;
  }
  return commands;
}

TEST_F(CompositedFilm, CommandsOfTheManualRun) {
  if (!has_ffmpeg() || !writes_exr()) GTEST_SKIP() << "ffmpeg or OpenEXR is not installed";
  const Result made = run(folder_.path, {"render", "cubes-on-ground", "--quiet", "--frames", "20", "--passes", "masks",
                                         "--set", "look.backdrop=shadows", "--set", "output.width=320", "--set",
                                         "output.height=180", "--format", "mov", "--out", "out/cubes"});
  ASSERT_EQ(made.status, 0) << made.err;
  ASSERT_TRUE(run_program({"ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc2=size=400x300", "-frames:v", "1",
                           file_word(path("photo.jpg"))}));
  const std::vector<std::string> commands =
      commands_of(read_file(test::source_folder / "docs" / "exchange.md"), "Compositing");
  EXPECT_EQ(commands.size(), 7U);
  for (const std::string& command : commands) {
    const std::string line = fmt::format("cd '{}' && {} < /dev/null > log.txt 2>&1", folder_.path.string(), command);
    ASSERT_EQ(std::system(line.c_str()), 0) << command << "\n" << read_file(path("log.txt"));
    const std::string film = command.substr(command.rfind(' ') + 1);
    EXPECT_GE(count_video_frames(path(film)), 20) << command;
  }
}

}  // namespace compositing_test
}  // namespace supple
