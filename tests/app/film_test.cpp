// Tests the film itself: how many frames it has, their colours, what happens to it when ffmpeg is killed or the run is
// ended, and a film without files of its frames.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/child_program.h"
#include "output/files/png_file.h"
#include "output/video/video.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace film_test {

using test::read_file;
using test::Result;
using test::run;

bool has_ffmpeg() {
  const auto told = run_program({"ffmpeg", "-encoders"});
  return told && told->status == 0 && run_program({"ffprobe", "-version"});
}

class FilmOfABar : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
    std::ofstream(folder_.path / "bar.toml") << R"(frames = 12
[[body]]
name = "bar"
box = { extent = [0.4, 0.2, 0.2], cells = [8, 4, 4] }
material = "jelly"
color = [0.9, 0.35, 0.05]
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[output]
width = 320
height = 180
samples = 1
)";
  }
  Result film(const std::string& out, std::vector<std::string> more = {}, const std::filesystem::path& signal_when = {},
              int signal = SIGINT) const {
    more.insert(more.begin(), {"render", "bar.toml", "--quiet", "--out", out});
    return run(folder_.path, more, signal_when, signal);
  }
  std::filesystem::path video(const std::string& out) const { return folder_.path / out / "video.mp4"; }
  int pictures(const std::string& out) const {
    const std::filesystem::directory_iterator files(folder_.path / out / "frames");
    return static_cast<int>(std::count_if(begin(files), end(files), [](const auto& f) { return looks_whole(f); }));
  }
  // Puts a program in the place of ffmpeg. Returns what must precede a shell's command line.
  std::string with_ffmpeg(const std::string& script) const {
    std::filesystem::create_directory(folder_.path / "bin");
    std::ofstream(folder_.path / "bin" / "ffmpeg") << "#!/bin/sh\n" << script << "\n";
    chmod((folder_.path / "bin" / "ffmpeg").c_str(), 0755);
    return "PATH=$PWD/bin:$PATH";
  }
  Result in_shell(const std::string& line) const {
    std::ofstream(folder_.path / "line.sh") << "cd '" << folder_.path.string() << "'\n" << line << "\n";
    const int status = std::system(
        fmt::format("bash '{0}/line.sh' > '{0}/stdout.txt' 2> '{0}/stderr.txt'", folder_.path.string()).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder_.path / "stdout.txt"),
            read_file(folder_.path / "stderr.txt")};
  }
  // Asks ffprobe for the colour tags of the film.
  std::string colours(const std::string& out) const {
    const auto told = run_program({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                   "stream=color_range,color_space,color_transfer,color_primaries,pix_fmt", "-of",
                                   "default=noprint_wrappers=1", video(out).string()});
    return told ? told->output : "";
  }

  test::TemporaryFolder folder_;
};

TEST_F(FilmOfABar, HasItsFramesAndSaysInWhichColours) {
  ASSERT_EQ(film("out").status, 0);
  EXPECT_EQ(count_video_frames(video("out")), 12);
  EXPECT_EQ(pictures("out"), 12);
  const std::string told = colours("out");
  for (const char* line : {"pix_fmt=yuv420p\n", "color_range=tv\n", "color_space=bt709\n", "color_primaries=bt709\n",
                           "color_transfer=iec61966-2-1\n"})
    EXPECT_NE(told.find(line), std::string::npos) << told;
}

// The picture consists of flat patches, because chroma is stored at half the size and edges are smoothed.
TEST_F(FilmOfABar, ShowsColoursAsTheyAreInTheFrames) {
  constexpr int side = 64;
  const std::vector<std::array<int, 3>> patches = {{230, 89, 13}, {255, 0, 0},     {0, 255, 0},     {0, 0, 255},
                                                   {0, 0, 0},     {255, 255, 255}, {128, 128, 128}, {204, 153, 102},
                                                   {20, 40, 90},  {240, 200, 20}};
  const int width = side * int(patches.size());
  const auto patch = [&](int x) { return patches[std::size_t(x / side)]; };
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : patch(x)) rgb.push_back(std::uint8_t(value));
  VideoEncoder encoder(folder_.path / "patches.mp4", width, side, 30);
  for (int frame = 0; frame < 3; ++frame) EXPECT_TRUE(encoder.add(rgb));
  ASSERT_EQ(encoder.finish().outcome, VideoOutcome::written);
  const auto decoded = run_program({"ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i",
                                    (folder_.path / "patches.mp4").string(), (folder_.path / "%d.png").string()});
  ASSERT_TRUE(decoded && decoded->status == 0);
  for (const char* file : {"1.png", "3.png"}) {
    const PngImage shown = read_png(folder_.path / file);
    ASSERT_EQ(shown.rgb.size(), rgb.size());
    for (int x = side / 2; x < width; x += side) {
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(shown.rgb[(std::size_t(side / 2) * width + x) * 3 + c], patch(x)[c], 3) << x << ' ' << c;
    }
  }
}

TEST_F(FilmOfABar, WithoutFilesIsTheSameFilm) {
  ASSERT_EQ(film("a").status, 0);
  const Result only = film("b", {"--film-only"});
  ASSERT_EQ(only.status, 0) << only.err;
  EXPECT_EQ(read_file(video("a")), read_file(video("b")));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path / "b" / "frames"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "b" / "checkpoint" / "state"));
  EXPECT_EQ(test::profile_of(folder_.path / "b")["frames"].size(), 12u);

  // A run that was killed is started again from the first frame.
  EXPECT_EQ(film("c", {"--film-only", "--frames", "20000"}, folder_.path / "c" / "motion" / "bar.pc2", SIGKILL).status,
            -SIGKILL);
  const Result on = film("c", {"--film-only", "--resume"});
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find("has no checkpoint yet; starting with the first frame"), std::string::npos) << on.err;
  EXPECT_EQ(read_file(video("a")), read_file(video("c")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "c" / "video.part.mp4"));

  // A checkpoint that has files of its frames belongs to another kind of film.
  const Result other = film("a", {"--film-only", "--resume"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("images: true and \"film only\""), std::string::npos) << other.err;
  EXPECT_EQ(pictures("a"), 12);
  EXPECT_EQ(film("a", {"--film-only", "--no-video"}).status, 2);
}

// Browsers show a picture of a GIF that lasts a hundredth of a second for a tenth.
TEST_F(FilmOfABar, KeepsItsSpeedAsAGif) {
  for (const double fps : {120.0, 60.0, 50.0, 30.0}) {
    const std::filesystem::path file = folder_.path / "film.gif";
    VideoEncoder encoder(file, 16, 16, fps, {FilmFormat::gif, FilmQuality::good});
    const int frames = static_cast<int>(fps);  // a second
    for (int frame = 0; frame < frames; ++frame)
      EXPECT_TRUE(encoder.add(std::vector<std::uint8_t>(16 * 16 * 3, std::uint8_t(2 * frame))));
    EXPECT_EQ(encoder.frames(), frames);
    ASSERT_EQ(encoder.finish().outcome, VideoOutcome::written) << fps;
    const std::string bytes = read_file(file), mark = "\x21\xf9\x04";
    int hundredths = 0, pictures = 0;
    for (std::size_t at = bytes.find(mark); at != std::string::npos; at = bytes.find(mark, at + 1), ++pictures) {
      const int delay = static_cast<unsigned char>(bytes[at + 4]) + 256 * static_cast<unsigned char>(bytes[at + 5]);
      EXPECT_GE(delay, 2) << fps;
      hundredths += delay;
    }
    EXPECT_NEAR(hundredths, 100, 2) << fps;
    EXPECT_EQ(pictures, fps == 120 ? 40 : fps == 60 ? 30 : frames);
  }
}

TEST_F(FilmOfABar, HasItsRateAsAFraction) {
  const auto rate_of = [](const std::filesystem::path& file) {
    const auto told = run_program({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                   "stream=r_frame_rate,avg_frame_rate,duration_ts,time_base", "-of",
                                   "default=noprint_wrappers=1", file.string()});
    return told ? told->output : "";
  };
  for (const auto& [fps, rate] :
       {std::pair{"30000/1001", "30000/1001"}, {"23.976", "24000/1001"}, {"24", "24/1"}, {"12.5", "25/2"}}) {
    const Result result = film("out", {"--force", "--set", std::string("fps=") + fps, "--page"});
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string told = rate_of(video("out"));
    EXPECT_NE(told.find(std::string("r_frame_rate=") + rate), std::string::npos) << told;
    EXPECT_NE(told.find(std::string("avg_frame_rate=") + rate), std::string::npos) << told;
    EXPECT_EQ(count_video_frames(video("out")), 12);
  }
  ASSERT_EQ(film("tv", {"--set", "fps=30000/1001"}).status, 0);
  const auto profile = nlohmann::json::parse(read_file(folder_.path / "tv" / "profile.json"));
  EXPECT_EQ(profile["frames"][11]["time_s"].get<double>(), 12 * 1001 / 30000.0);
  EXPECT_EQ(film("out", {"--set", "fps=30000/0"}).status, 2);
  const Result drawn = run(folder_.path, {"draw", "tv", "--rate", "60000/1001", "--quiet", "--out", "fast"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_NE(rate_of(video("fast")).find("r_frame_rate=60000/1001"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_.path / "fast" / "draw.json"))["rate"], "60000/1001");
  const Result wrong = run(folder_.path, {"draw", "tv", "--rate", "60000/x"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.err,
            "--rate 60000/x: must be a number such as 25 or 23.976, or a fraction of two whole numbers such as "
            "30000/1001, from 0.01 to 1000\n");
}

// Ten minutes of television's rate have a frame for each 1001/30000 s, and the film's file as well.
TEST_F(FilmOfABar, DoesNotDriftInTenMinutes) {
  const FrameRate rate = *FrameRate::parse("30000/1001");
  const std::filesystem::path file = folder_.path / "long.mp4";
  VideoEncoder encoder(file, 16, 16, rate, {FilmFormat::mp4, FilmQuality::draft});
  const int frames = 17982;
  const std::vector<std::uint8_t> grey(16 * 16 * 3, 128);
  for (int frame = 0; frame < frames; ++frame) ASSERT_TRUE(encoder.add(grey));
  ASSERT_EQ(encoder.finish().outcome, VideoOutcome::written);
  const auto told = run_program({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries", "stream=duration",
                                 "-of", "csv=p=0", file.string()});
  ASSERT_TRUE(told);
  EXPECT_NEAR(std::stod(told->output), rate.time_of(frames), 1e-6);
}

TEST_F(FilmOfABar, SaysWhatItsFormatCannotHold) {
  const auto warned = [&](const std::string& format, const std::vector<std::string>& settings) {
    std::vector<std::string> words = {"--force", "--frames", "2", "--format", format};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    const Result result = film("out", words);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  const std::string clear = "look.backdrop=transparent";
  EXPECT_EQ(
      warned("gif", {"fps=60"}),
      "warning: a GIF shows no more than 50 pictures a second: of 60, it has one in 2, and its speed is that of the "
      "film\n");
  EXPECT_EQ(warned("gif", {"fps=50"}) + warned("mp4", {"fps=60"}) + warned("png", {clear}) + warned("webm", {clear}),
            "");
  const Result drawn = run(folder_.path, {"draw", "out", "--format", "gif", "--rate", "100", "--quiet"});
  EXPECT_NE(drawn.err.find("of 100, it has one in 2"), std::string::npos) << drawn.err;
}

// To ffmpeg, such a name by itself would be a protocol or an option.
TEST_F(FilmOfABar, GoesIntoAFolderOfAnyName) {
  for (const std::string name : {"take:1", "concat:1|2", "-dash", "http://nowhere.invalid/film"}) {
    const Result result = run(folder_.path, {"render", "bar.toml", "--quiet", "--out=" + name});
    EXPECT_EQ(result.status, 0) << name << result.err;
    EXPECT_EQ(count_video_frames(folder_.path / name / "video.mp4"), 12) << name;
    const Result drawn = run(folder_.path, {"draw", "--quiet", "--jobs", "2", "--out=" + name + "-again", "--", name});
    EXPECT_EQ(drawn.status, 0) << name << drawn.err;
    EXPECT_EQ(count_video_frames(folder_.path / (name + "-again") / "video.mp4"), 12) << name;
  }
}

TEST_F(FilmOfABar, IsMissedAloudWithoutFfmpeg) {
  const std::string program = fmt::format("PATH=/nowhere '{}'", test::program_name);
  const std::string message = "warning: no film: ffmpeg is not installed (Debian: ffmpeg); the {} are whole\n";
  for (const char* more : {"--quiet", "--json", ""}) {
    const Result result = in_shell(program + " render bar.toml --force --out out " + more);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find(fmt::format(fmt::runtime(message), "frames")), std::string::npos) << result.err;
    EXPECT_EQ(pictures("out"), 12);
  }
  const Result drawn = in_shell(program + " draw out --quiet");
  EXPECT_EQ(drawn.status, 0);
  EXPECT_EQ(drawn.err, fmt::format(fmt::runtime(message), "pictures"));
  const Result split = in_shell(program + " draw out out --quiet");
  EXPECT_EQ(split.status, 0);
  EXPECT_EQ(split.err, fmt::format(fmt::runtime(message), "pictures"));
}

TEST_F(FilmOfABar, WithoutFilesNeedsFfmpegToTheEnd) {
  const std::string program = fmt::format("'{}' render bar.toml --quiet --film-only", test::program_name);
  const Result without = in_shell("PATH=/nowhere " + program);
  EXPECT_EQ(without.status, 2);
  EXPECT_EQ(without.err, "--film-only: needs ffmpeg, which is not installed (Debian: ffmpeg)\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "out"));
  const Result dying = in_shell(with_ffmpeg("[ \"$1\" = -version ] || { head -c 1000 > /dev/null; kill -9 $$; }") +
                                " " + program + " --set output.width=640 --set output.height=480");
  EXPECT_EQ(dying.status, 1) << dying.err;
  EXPECT_NE(dying.err.find("supple: no film: ffmpeg was ended by signal 9\n"), std::string::npos) << dying.err;
  EXPECT_EQ(dying.err.find("whole"), std::string::npos) << dying.err;
  EXPECT_FALSE(std::filesystem::exists(video("out/bar")));
}

TEST_F(FilmOfABar, AnEncoderThatDiesInTheMiddleCostsNoFrame) {
  // The pictures are so large that the pipe holds only one of them.
  const std::string program =
      fmt::format("'{}' render bar.toml --quiet --set output.width=640 --set output.height=480", test::program_name);
  const std::pair<const char*, const char*> ends[] = {
      {"head -c 3000000 > /dev/null; echo out of luck; kill -9 $$",
       "supple: no film: ffmpeg was ended by signal 9; the frames are whole. out of luck\n"},
      {"exec < /dev/null; sleep 1; exit 1", "supple: no film: ffmpeg ended with status 1; the frames are whole\n"},
      {"head -c 3000000 > /dev/null; exit 0",
       "supple: no film: ffmpeg ended before it had all frames; the frames are whole\n"},
      {"yes '0123456789' | head -c 1000000; cat > /dev/null; exit 3", "supple: no film: ffmpeg ended with status 3"}};
  for (const auto& [script, message] : ends) {
    const Result result = in_shell(with_ffmpeg(script) + " " + program);
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
    EXPECT_EQ(pictures("out/bar"), 12) << script;
    EXPECT_EQ(test::profile_of(folder_.path / "out" / "bar")["frames"].size(), 12u);
    EXPECT_FALSE(std::filesystem::exists(video("out/bar")));
    EXPECT_FALSE(std::filesystem::exists(folder_.path / "out" / "bar" / "video.part.mp4"));
  }
}

// A terminal sends SIGINT to all programs of the command.
TEST_F(FilmOfABar, IsWholeUpToAnInterruptOfTheWholeGroup) {
  for (const char* more : {"", "--film-only"}) {
    std::filesystem::remove_all(folder_.path / "out");
    const Result result =
        in_shell(fmt::format("set -m\n'{}' render bar.toml --quiet --frames 20000 {} &\nprogram=$!\n"
                             "until [ -s out/bar/motion/bar.pc2 ]; do sleep 0.01; done\nsleep 0.5\n"
                             "kill -INT -$program\nwait $program",
                             test::program_name, more));
    EXPECT_EQ(result.status, 130) << result.err;
    const auto frames = static_cast<int>(test::profile_of(folder_.path / "out" / "bar")["frames"].size());
    EXPECT_GT(frames, 0);
    EXPECT_EQ(count_video_frames(video("out/bar")), frames);
    EXPECT_EQ(pictures("out/bar"), *more == '\0' ? frames : 0);
  }
}

TEST_F(FilmOfABar, GoesOnFromTheFilesOfItsFrames) {
  ASSERT_EQ(film("whole", {"--frames", "20"}).status, 0);
  ASSERT_EQ(film("cut", {"--no-video"}).status, 0);
  ASSERT_EQ(film("cut", {"--resume", "--frames", "20"}).status, 0);
  EXPECT_EQ(read_file(video("whole")), read_file(video("cut")));
  ASSERT_EQ(film("cut", {"--resume", "--frames", "20"}).status, 0);  // no frame is made
  EXPECT_EQ(read_file(video("whole")), read_file(video("cut")));

  // A file that begins and ends as it should but is damaged in between costs the film and nothing else.
  const std::filesystem::path frame = folder_.path / "cut" / "frames" / "000003.png";
  std::string bytes = read_file(frame);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(frame, std::ios::binary) << bytes;
  const Result damaged = film("cut", {"--resume", "--frames", "22"});
  EXPECT_EQ(damaged.status, 1);
  EXPECT_NE(damaged.err.find("supple: no film: " + (std::filesystem::path("cut") / "frames" / "000003.png").string()),
            std::string::npos)
      << damaged.err;
  EXPECT_EQ(pictures("cut"), 22);
  EXPECT_FALSE(std::filesystem::exists(video("cut")));
}

}  // namespace film_test
}  // namespace supple
