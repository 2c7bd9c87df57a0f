// Tests failures from outside: the disk, ffmpeg, and files that were damaged. Each gives a message and an exit status,
// and nothing is lost.
#include <sys/stat.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/folder_lock.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace faults_test {

using test::Result;
using test::run;

class Faults : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "bar.toml") << R"(frames = 8
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
material = "jelly"
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[output]
width = 96
height = 64
samples = 1
)";
  }
  // Runs the program through a shell, after the commands in `before`.
  Result in_shell(const std::string& before, const std::string& arguments) const {
    const std::string command = fmt::format("cd '{}' && {} '{}' {} > stdout.txt 2> stderr.txt", folder_.path.string(),
                                            before, test::program_name, arguments);
    const int status = std::system(fmt::format("bash -c \"{}\"", command).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, test::read_file(folder_.path / "stdout.txt"),
            test::read_file(folder_.path / "stderr.txt")};
  }
  void expect_whole_frames(int count) const {
    const std::filesystem::path frames = folder_.path / "out" / "bar" / "frames";
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(frames), {}), count);
    for (int frame = 0; frame < count; ++frame) EXPECT_TRUE(looks_whole(frames / fmt::format("{:06}.png", frame)));
  }

  test::TemporaryFolder folder_;
};

TEST_F(Faults, WithoutFfmpegTheFramesAreWholeAndThePackageIsNamed) {
  const Result result = in_shell("PATH=/nowhere", "render bar.toml");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("ffmpeg is not installed (Debian: ffmpeg)"), std::string::npos) << result.err;
  expect_whole_frames(8);
}

TEST_F(Faults, AKilledFfmpegIsToldAndTheFramesAreWhole) {
  std::filesystem::create_directory(folder_.path / "bin");
  std::ofstream(folder_.path / "bin" / "ffmpeg") << "#!/bin/sh\nkill -9 $$\n";
  chmod((folder_.path / "bin" / "ffmpeg").c_str(), 0755);
  const Result result = in_shell("PATH=\\$PWD/bin:\\$PATH", "render bar.toml");
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.err.find("no film: ffmpeg"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("the frames are whole"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "out" / "bar" / "video.mp4"));
  expect_whole_frames(8);
}

// No file may become longer than the limit, which looks like a full disk to the solver's side of the program. (Mesa
// needs larger files than that in memory.)
TEST_F(Faults, AFullDiskEndsTheRunWithWhatWasWritten) {
  const Result result = in_shell("trap '' XFSZ; ulimit -f 4; ", "render bar.toml --no-images");
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.err.find("cannot be written: File too large"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("kept: "), std::string::npos) << result.err;
}

TEST_F(Faults, AFolderThatCannotBeWrittenIsNamed) {
  const Result result = in_shell("", "render bar.toml --out /proc/here");
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_EQ(result.err.substr(result.err.rfind("supple: ")),
            "supple: /proc/here: cannot be made: No such file or directory\n");
}

TEST_F(Faults, ARecordThatCannotBeWrittenIsRefusedBeforeTheEarlierFilmIsTouched) {
  const std::vector<std::string> film = {"render", "bar.toml", "--no-video", "--quiet", "--record"};
  const auto with = [&film](std::vector<std::string> more) {
    more.insert(more.begin(), film.begin(), film.end());
    return more;
  };
  ASSERT_EQ(run(folder_.path, with({"film.rec"})).status, 0);
  std::ofstream(folder_.path / "short.rec");
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"nowhere/film.rec"}, {"out"}, {"short.rec", "--resume"}, {"nowhere/film.rec", "--resume"}}) {
    const Result result = run(folder_.path, with(more));
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_NE(result.err.find(more[0] + ": "), std::string::npos) << result.err;
    expect_whole_frames(8);
    EXPECT_EQ(test::profile_of(folder_.path / "out" / "bar")["frames"].size(), 8u);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "nowhere"));
}

TEST_F(Faults, ARecordIsWrittenOverNothingButARecord) {
  const auto recorded = [this](const std::string& file) {
    return run(folder_.path, {"render", "bar.toml", "--no-images", "--quiet", "--record", file});
  };
  EXPECT_EQ(recorded("film.rec").status, 0);
  EXPECT_EQ(recorded("film.rec").status, 0);
  EXPECT_EQ(recorded("out/bar/film.rec").status, 0);
  const std::string scene = test::read_file(folder_.path / "bar.toml");
  for (const char* file : {"bar.toml", "out/bar/run.json", "out/bar/motion/bar.pc2", "out/bar/motion/new.rec"}) {
    const Result result = recorded(file);
    EXPECT_EQ(result.status, 2) << file;
    EXPECT_NE(result.err.find(std::string("--record ") + file), std::string::npos) << result.err;
  }
  EXPECT_EQ(test::read_file(folder_.path / "bar.toml"), scene);
  EXPECT_EQ(test::profile_of(folder_.path / "out" / "bar")["frames"].size(), 8u);
}

TEST_F(Faults, ARecordThatVerifiesNothingIsAFailure) {
  const std::vector<std::string> film = {"render", "bar.toml", "--no-images", "--quiet"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), film.begin(), film.end());
    return run(folder_.path, more);
  };
  ASSERT_EQ(with({"--record", "film.rec"}).status, 0);
  EXPECT_EQ(with({"--verify", "film.rec"}).status, 0);
  const Result complete = with({"--verify", "film.rec", "--resume"});
  EXPECT_EQ(complete.status, 1);
  EXPECT_NE(complete.err.find("verified: nothing; the film was complete already"), std::string::npos) << complete.err;
  const Result behind = with({"--verify", "film.rec", "--resume", "--frames", "9"});
  EXPECT_EQ(behind.status, 1);
  EXPECT_NE(behind.err.find("verified: nothing; the record ends before"), std::string::npos) << behind.err;
  std::ofstream(folder_.path / "film.rec", std::ios::app) << "more";
  const Result damaged = with({"--verify", "film.rec"});
  EXPECT_EQ(damaged.status, 2);
  EXPECT_NE(damaged.err.find("is damaged: after 8 whole frames"), std::string::npos) << damaged.err;
}

TEST_F(Faults, ADamagedFrameIsFoundBeforeGoingOn) {
  ASSERT_EQ(run(folder_.path, {"render", "bar.toml", "--no-video", "--quiet"}).status, 0);
  const std::filesystem::path frame = folder_.path / "out" / "bar" / "frames" / "000003.png";
  write_whole_file(frame, std::string_view("x"));
  EXPECT_FALSE(looks_whole(frame));
  const Result result = run(folder_.path, {"render", "bar.toml", "--no-video", "--resume", "--frames", "10"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("000003.png: is missing or damaged"), std::string::npos) << result.err;
  EXPECT_EQ(test::profile_of(folder_.path / "out" / "bar")["frames"].size(), 8u);  // all else is as it was
}

// A terminal that is closed sends SIGHUP; nohup makes the program ignore it.
TEST_F(Faults, AClosedTerminalEndsTheFilmAfterItsFrameUnlessNohupSaysOtherwise) {
  const std::filesystem::path out = folder_.path / "out" / "bar";
  const std::vector<std::string> film = {"render", "bar.toml", "--no-images", "--frames", "20000"};
  const Result closed = run(folder_.path, film, out / "motion" / "bar.pc2", SIGHUP);
  EXPECT_EQ(closed.status, 130) << closed.err;
  EXPECT_NE(closed.err.find("supple: interrupted after "), std::string::npos) << closed.err;
  EXPECT_TRUE(std::filesystem::exists(out / "profile.json"));
  std::filesystem::remove_all(out);
  std::signal(SIGHUP, SIG_IGN);
  const Result nohup =
      run(folder_.path, {"render", "bar.toml", "--no-images", "--frames", "60"}, out / "motion" / "bar.pc2", SIGHUP);
  std::signal(SIGHUP, SIG_DFL);
  EXPECT_EQ(nohup.status, 0) << nohup.err;
}

TEST_F(Faults, WordsForAClosedStreamDoNotLandInResults) {
  const auto motion = [&](const std::string& streams) {
    const std::string line =
        fmt::format("cd '{}' && '{}' render bar.toml {}", folder_.path.string(), test::program_name, streams);
    EXPECT_EQ(std::system(fmt::format("bash -c \"{}\"", line).c_str()), 0) << streams;
    return test::read_file(folder_.path / "out" / "bar" / "motion" / "bar.pc2");
  };
  const std::string whole = motion("> words.txt 2>&1");
  for (const char* streams : {"2>&-", "> words.txt 2>&-", "<&- >&- 2>&-"}) EXPECT_EQ(motion(streams), whole) << streams;
}

TEST_F(Faults, AFolderThatAnotherRunWritesIntoIsLeftAlone) {
  std::ofstream(folder_.path / "bar.toml", std::ios::app) << "[sweep.values]\n\"body.bar.density\" = [900, 1000]\n";
  const auto expect_refused = [&](const std::string& held, std::vector<std::string> words) {
    words.insert(words.end(), {"--no-images", "--quiet"});
    std::string before, record;
    {
      const FolderLock lock(folder_.path / held);
      before = test::read_file(folder_.path / held / "run.json");
      record = test::read_file(folder_.path / held / "point.json");
      const Result refused = run(folder_.path, words);
      EXPECT_EQ(refused.status, 2) << held << refused.out;
      EXPECT_EQ(refused.err, "--out " + held +
                                 ": another run writes into this folder now; wait until it has ended, or choose "
                                 "another folder\n");
    }
    EXPECT_EQ(test::read_file(folder_.path / held / "run.json"), before);
    EXPECT_EQ(test::read_file(folder_.path / held / "point.json"), record);
    EXPECT_EQ(run(folder_.path, words).status, 0) << held;  // once the folder is free
  };
  const std::vector<std::string> film = {"render", "bar.toml"}, resumed = {"render", "bar.toml", "--resume"},
                                 point = {"sweep", "bar.toml", "--index", "1"}, points = {"sweep", "bar.toml"};
  expect_refused("out/bar", film);
  expect_refused("out/bar", film);  // where a run has been
  expect_refused("out/bar", resumed);
  expect_refused("out/bar-sweep/points/0001", point);
  expect_refused("out/bar-sweep/points/0001", point);
  expect_refused("out/bar-sweep", points);
}

}  // namespace faults_test
}  // namespace supple
