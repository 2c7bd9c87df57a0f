// Tests where a run goes and what it leaves there: folders of other runs, scenes from standard input, previews, formats
// and stills.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/child_program.h"
#include "output/files/png_file.h"
#include "output/run/run_folder.h"
#include "output/video/video.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace film_folder_test {

using test::read_file;
using test::Result;
using test::run;

class FilmFolder : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(path("bar.toml")) << bar; }

  std::filesystem::path path(const std::string& name) const { return folder_.path / name; }
  std::filesystem::path out(const std::string& name) const { return folder_.path / "out" / name; }
  Result film(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"render", "bar.toml", "--quiet"});
    return run(folder_.path, more);
  }
  nlohmann::json info(const std::string& name) const {
    return nlohmann::json::parse(read_file(out(name) / "run.json"));
  }
  int pictures(const std::string& name) const {
    int count = 0;
    while (std::filesystem::exists(picture_file(out(name) / "frames", count))) ++count;
    return count;
  }
  // Runs the program with a text on standard input.
  Result with_input(const std::string& text, const std::string& words) const {
    std::ofstream(path("input.txt")) << text;
    const std::string line = fmt::format("cd '{}' && '{}' {} < input.txt > stdout.txt 2> stderr.txt",
                                         folder_.path.string(), test::program_name, words);
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(path("stdout.txt")), read_file(path("stderr.txt"))};
  }
  static bool has_ffmpeg() { return run_program({"ffmpeg", "-version"}) && run_program({"ffprobe", "-version"}); }

  static constexpr const char* bar = R"(frames = 5
[[body]]
name = "bar"
box = { extent = [0.4, 0.2, 0.2], cells = [8, 4, 4] }
material = "jelly"
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[output]
width = 320
height = 180
samples = 1
)";
  test::TemporaryFolder folder_;
};

const std::vector<std::string> heavier = {"--no-images", "--set", "body.bar.density=900"};

TEST_F(FilmFolder, ThatIsNotThereIsNamed) {
  const auto in_shell = [this](const std::string& line) {
    const std::string all = fmt::format("cd '{}' && {{ {}; }} > stdout.txt 2> stderr.txt", folder_.path.string(), line);
    const int status = std::system(fmt::format("bash -c \"{}\"", all).c_str());
    return Result{WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", read_file(path("stderr.txt"))};
  };
  const std::string gone = path("gone").string();
  const Result working =
      in_shell(fmt::format("mkdir gone; cd gone; rmdir '{0}'; '{1}' list", gone, test::program_name));
  EXPECT_EQ(working.status, 2);
  EXPECT_EQ(working.err,
            gone +
                ": the folder that the command was called in cannot be used: No such file or directory; cd "
                "to one that is there\n");
}

TEST_F(FilmFolder, WithWordsThatTheFontLacksSaysSo) {
  // These two characters are for private use, and no font that is shared has them.
  const std::vector<std::string> words = {"--set", "title='\xef\x83\xbf A \xf4\x8f\xbf\xbd'", "--set",
                                          "body.bar.label='\xef\x83\xbf'"};
  const auto with = [&words](std::vector<std::string> line) {
    line.insert(line.end(), words.begin(), words.end());
    return line;
  };
  const std::string warning =
      "no font has '\xef\x83\xbf', '\xf4\x8f\xbf\xbd', which the title and the caption of 'bar' have: "
      "boxes are drawn instead; ";
  const Result checked = run(folder_.path, with({"check", "bar.toml"}));
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find(warning), std::string::npos) << checked.out;
  const Result filmed = run(folder_.path, with({"render", "bar.toml", "--frames", "1", "--no-video"}));
  EXPECT_NE(filmed.err.find(warning), std::string::npos) << filmed.err;
  EXPECT_EQ(run(folder_.path, with({"render", "bar.toml", "--frames", "1", "--no-images"})).err.find("boxes"),
            std::string::npos);
  EXPECT_EQ(run(folder_.path, {"check", "bar.toml", "--set", "body.bar.label='gr\xc3\xbcn'"}).out.find("boxes"),
            std::string::npos);
}

TEST_F(FilmFolder, OfAnotherRunStaysAndTheNewRunIsNumbered) {
  ASSERT_EQ(film({"--no-images"}).status, 0);
  const std::string before = read_file(out("bar") / "run.json");
  const Result second = film(heavier);
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_EQ(second.err,
            "note: out/bar holds another run, which stays; this one goes to out/bar-2 (--force overwrites)\n");
  EXPECT_EQ(read_file(out("bar") / "run.json"), before);
  EXPECT_EQ(info("bar-2")["scene"]["body"][0]["density"], 900);
  ASSERT_EQ(film(heavier).status, 0);  // takes its own folder over
  EXPECT_FALSE(std::filesystem::exists(out("bar-3")));
  std::filesystem::create_directory(out("bar-3"));
  std::ofstream(out("bar-3") / "notes.txt") << "somebody's own\n";
  ASSERT_EQ(film({"--no-images", "--frames", "3"}).status, 0);
  EXPECT_EQ(info("bar-4")["frames"], 3);
  ASSERT_EQ(film({"--no-images", "--frames", "3", "--force"}).status, 0);
  EXPECT_EQ(info("bar")["frames"], 3);
  ASSERT_EQ(film({"--no-images", "--out", "out/bar/", "--frames", "2"}).status, 0);
  EXPECT_EQ(info("bar-5")["frames"], 2);
}

TEST_F(FilmFolder, OfTheSameFilmIsTakenOver) {
  const auto loud = [this](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "bar.toml", "--no-images"});
    return run(folder_.path, more);
  };
  EXPECT_EQ(loud({}).err.find("note:"), std::string::npos);
  const Result again = loud({});
  ASSERT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("note: out/bar holds this same film, which is made again\n"), std::string::npos)
      << again.err;
  const auto told = nlohmann::json::parse(loud({"--json", "--frames", "2"}).out);
  EXPECT_EQ(told["folder"], "out/bar-2");
}

TEST_F(FilmFolder, KeepsPicturesThatTheNewRunWouldNotMake) {
  ASSERT_EQ(film({"--no-video"}).status, 0);
  ASSERT_EQ(film({"--no-images"}).status, 0);
  EXPECT_EQ(pictures("bar"), 5);
  EXPECT_EQ(pictures("bar-2"), 0);
  ASSERT_EQ(film({"--no-video"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out("bar-3")));
}

TEST_F(FilmFolder, OfAnInterruptedNumberedRunIsNamedForResuming) {
  ASSERT_EQ(film({"--no-images"}).status, 0);
  // The first checkpoint says that there is a frame to go on from.
  const std::filesystem::path checkpoint = RunFolder::checkpoint_of(out("bar-2"));
  const Result cut = run(
      folder_.path, {"render", "bar.toml", "--no-images", "--frames", "100000", "--checkpoint-every", "1"}, checkpoint);
  ASSERT_EQ(cut.status, 130) << cut.err;
  EXPECT_NE(cut.err.find("; --resume --out out/bar-2 goes on\n"), std::string::npos) << cut.err;
  const int kept = info("bar-2")["frames"];
  const Result on = run(folder_.path, {"render", "bar.toml", "--no-images", "--frames", std::to_string(kept + 2),
                                       "--resume", "--out", "out/bar-2"});
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_EQ(info("bar-2")["frames"], kept + 2);
}

TEST_F(FilmFolder, OfASceneOnStandardInputCanBeDrawnAgain) {
  const std::string ball = std::string(bar) + "[[collider]]\nname = \"ball\"\nshape = \"ball.toml\"\n";
  std::ofstream(path("ball.toml")) << "[[part]]\nsphere = { radius = 0.1 }\n";
  const Result made = with_input(ball, "render - --quiet --no-video");
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(info("stdin")["scene_text"], ball);
  ASSERT_EQ(run(folder_.path, {"draw", "out/stdin", "--quiet", "--format", "png"}).status, 0);
  EXPECT_EQ(read_file(picture_file(out("stdin-drawn") / "frames", 3)),
            read_file(picture_file(out("stdin") / "frames", 3)));
  EXPECT_NE(with_input(ball, "check -").out.find("stdin: no errors"), std::string::npos);
  EXPECT_NE(with_input(ball, "info -").out.find("scene           stdin"), std::string::npos);
  EXPECT_NE(with_input(ball, "info --live -").out.find("body.bar.material"), std::string::npos);
}

TEST_F(FilmFolder, IsNotMadeForAWrongSceneOnStandardInput) {
  for (const char* words : {"render - --no-images", "check -", "info -"}) {
    const Result wrong = with_input("\nfrmes = 3\n" + std::string(bar), words);
    EXPECT_EQ(wrong.status, 2) << words;
    EXPECT_EQ(wrong.err, "<stdin>:2:1: unknown key 'frmes'; did you mean 'frames'?\n") << words;
    EXPECT_EQ(with_input("frames = \n", words).err.find("<stdin>:1:"), 0u) << words;
  }
  const Result large = with_input("# " + std::string(1'100'000, 'x') + "\n", "check -");
  EXPECT_EQ(large.status, 2);
  EXPECT_EQ(large.err, "<stdin>: is larger than 1.0 MB\n");
  EXPECT_EQ(with_input(bar, "profile -").status, 2);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(FilmFolder, OfAPreviewHasAQuarterOfTheSizeAndHalfThePictures) {
  const Result result = run(folder_.path, {"render", "bar.toml", "--preview"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("preview: 320 x 180 pixels, every other frame; 'bar' has "), std::string::npos)
      << result.err;
  EXPECT_EQ(pictures("bar-preview"), 3);
  EXPECT_EQ(read_png(picture_file(out("bar-preview") / "frames", 2)).width, 320);
  const Result wide = run(folder_.path, {"render", "bar.toml", "--preview", "--frames", "1", "--no-video", "--out",
                                         "wide", "--set", "output.width=1280", "--set", "output.height=720"});
  EXPECT_NE(wide.err.find("preview: 480 x 270 pixels"), std::string::npos) << wide.err;
  const Result wider = run(folder_.path, {"render", "bar.toml", "--preview", "--frames", "1", "--no-images", "--out",
                                          "wider", "--set", "output.width=3840", "--set", "output.height=2160"});
  EXPECT_NE(wider.err.find("preview: 960 x 540 pixels"), std::string::npos) << wider.err;
  EXPECT_EQ(info("bar-preview")["frames"], 5) << "all frames are simulated";
  EXPECT_LT(info("bar-preview")["meshes"][0]["vertices"], 9 * 5 * 5);
  if (has_ffmpeg()) {
    EXPECT_EQ(count_video_frames(out("bar-preview") / "video.mp4"), 3);
  }
  ASSERT_EQ(film({"--preview", "--set", "body.bar.density=900"}).status, 0);
  EXPECT_EQ(info("bar-preview")["scene"]["body"][0]["density"], 900) << "a preview replaces the one before";
  EXPECT_EQ(run(folder_.path, {"draw", "out/bar-preview", "--quiet"}).status, 0);
  EXPECT_EQ(film({"--preview", "--resume"}).status, 2);
  ASSERT_EQ(film({"--no-images", "--out", "out/bar-preview"}).status, 0);
  EXPECT_EQ(info("bar-preview")["preview"], true) << "a run does not replace a preview";
}

// A quarter of the vertices cannot hold the sheet; half of them can.
TEST_F(FilmFolder, OfAPreviewHasFinerElementsWhereTheBodyIsThin) {
  std::ofstream(path("sheet.toml")) << "[[part]]\nbox = { extent = [1, 0.03, 1] }\n";
  std::ofstream(path("thin.toml")) << "frames = 1\n[[body]]\nname = \"sheet\"\nshape = \"sheet.toml\"\n"
                                      "material = \"rubber\"\nvertices = 3000\n[output]\nwidth = 64\nheight = 64\n";
  const Result result = run(folder_.path, {"render", "thin.toml", "--preview", "--no-video"});
  ASSERT_EQ(result.status, 0) << result.err;
  const int vertices = info("thin-preview")["meshes"][0]["vertices"];
  EXPECT_GT(vertices, 1000);
}

TEST_F(FilmFolder, HasAFilmOfAnyFormat) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  for (const auto& [format, file] : std::vector<std::pair<std::string, std::string>>{
           {"gif", "video.gif"}, {"webm", "video.webm"}, {"mp4", "video.mp4"}}) {
    const Result result = film({"--force", "--format", format, "--quality", "draft"});
    ASSERT_EQ(result.status, 0) << format << ": " << result.err;
    EXPECT_EQ(count_video_frames(out("bar") / file), 5) << format;
    EXPECT_EQ(info("bar")["video"], file);
    EXPECT_EQ(run(folder_.path, {"page", "out/bar"}).status, 0);
    EXPECT_NE(read_file(out("bar") / "index.html").find(format == "gif" ? "data:image/gif" : "data:video/" + format),
              std::string::npos)
        << format;
  }
  EXPECT_FALSE(std::filesystem::exists(out("bar") / "video.gif")) << "an earlier film of the folder is still there";
  ASSERT_EQ(film({"--force", "--format", "png"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out("bar") / "video.mp4"));
  EXPECT_FALSE(std::filesystem::exists(out("bar") / "index.html")) << "the page of an earlier film is still there";
  ASSERT_EQ(film({"--force", "--format", "mov"}).status, 0);
  EXPECT_EQ(run(folder_.path, {"page", "out/bar"}).status, 0);
  EXPECT_NE(read_file(out("bar") / "index.html").find("Browsers do not play the film of this run, video.mov; "),
            std::string::npos);
  ASSERT_EQ(film({"--no-video"}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(out("bar") / "video.mov")) << "a run that makes no film removed one";
  EXPECT_EQ(film({"--format", "avi"}).status, 2);
  EXPECT_EQ(film({"--quality", "excellent"}).status, 2);
  const Result none = film({"--film-only", "--format", "png"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.err, "--film-only: leaves a film, and --format png makes none\n");
}

TEST_F(FilmFolder, HasAPosterAndASheet) {
  ASSERT_EQ(film({"--no-video"}).status, 0);
  EXPECT_EQ(read_file(out("bar") / "poster.png"), read_file(picture_file(out("bar") / "frames", 2)));
  EXPECT_GT(read_png(out("bar") / "sheet.png").width, 3 * 320);
  ASSERT_EQ(film({"--no-video", "--no-stills"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out("bar") / "poster.png"));
  EXPECT_FALSE(std::filesystem::exists(out("bar") / "sheet.png"));
}

}  // namespace film_folder_test
}  // namespace supple
