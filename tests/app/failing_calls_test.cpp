// Every call on a run's files fails once, whichever it is: there is a status, one message that names the file, the
// frames that are there are whole, nothing is left under a temporary name, and the next run is as if nothing had been.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "output/files/png_file.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace failing_calls_test {

using test::Result;

class FailingCalls : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer must be loaded before any other library";
#endif
    std::ofstream(folder_.path / "bar.toml") << R"(frames = 3
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [4, 1, 1] }
material = "jelly"
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
[output]
width = 32
height = 32
samples = 1
)";
  }
  ~FailingCalls() override {
    for (const char* name : {"LD_PRELOAD", "FAILING_FOLDER", "FAILING_CALL", "FAILING_AT", "FAILING_COUNT",
                             "FAILING_PLUG", "FAILING_PROGRAM"})
      ::unsetenv(name);
  }

  Result run_with(const std::string& call, int at, const std::vector<std::string>& arguments) {
    // The program's output goes to files beside the run's folder; calls on those are left alone.
    const std::filesystem::path folder = std::filesystem::canonical(folder_.path);
    ::setenv("FAILING_FOLDER", (call == "read" ? folder : folder / "out").c_str(), 1);
    ::setenv("FAILING_CALL", call.c_str(), 1);
    ::setenv("FAILING_AT", std::to_string(at).c_str(), 1);
    ::setenv("FAILING_COUNT", (folder_.path / "count.txt").c_str(), 1);
    ::setenv("FAILING_PROGRAM", std::filesystem::canonical(test::program_name).c_str(), 1);
    ::setenv("LD_PRELOAD", test::failing_calls_name, 1);
    Result result = test::run(folder_.path, arguments);
    ::unsetenv("LD_PRELOAD");
    return result;
  }
  int counted() const { return std::atoi(test::read_file(folder_.path / "count.txt").c_str()); }

  void expect_whole() const {
    const std::filesystem::path out = folder_.path / "out" / "bar";
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out, error)) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(name.find(".part"), std::string::npos) << name;
      if (entry.path().extension() == ".png") {
        EXPECT_TRUE(looks_whole(entry.path())) << name;
      }
    }
  }
  // The messages that are neither warnings nor notes, nor the line about what is kept.
  static std::vector<std::string> errors_in(const std::string& text) {
    std::vector<std::string> list;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty() && !line.starts_with("warning: ") && !line.starts_with("note: ") && !line.starts_with(" "))
        list.push_back(line);
    }
    return list;
  }

  // Lets each call of a kind fail in turn. What a message must say about a run that is not done: a path.
  void fail_each(const std::string& call, const std::vector<std::string>& arguments, int fewest) {
    std::filesystem::remove_all(folder_.path / "out");
    ASSERT_EQ(run_with(call, 0, arguments).status, 0);
    const int calls = counted();
    EXPECT_GE(calls, fewest) << "the library does not see the calls";
    for (int at = 1; at <= calls; ++at) {
      SCOPED_TRACE(fmt::format("{} {} of {}", call, at, calls));
      std::filesystem::remove_all(folder_.path / "out");
      const Result result = run_with(call, at, arguments);
      const std::vector<std::string> errors = errors_in(result.err);
      if (result.status == 0) {  // a look at what an earlier run left, which is not needed
        EXPECT_EQ(call, "open");
        EXPECT_TRUE(errors.empty()) << result.err;
        EXPECT_EQ(test::profile_of(folder_.path / "out" / "bar")["frames"].size(), 3u);
      } else {
        EXPECT_TRUE(result.status == 1 || result.status == 2) << result.status << result.err;
        EXPECT_EQ(errors.size(), 1u) << result.err;
        EXPECT_NE(result.err.find("bar"), std::string::npos) << result.err;
      }
      expect_whole();
    }
    std::filesystem::remove_all(folder_.path / "out");
    EXPECT_EQ(test::run(folder_.path, arguments).status, 0);
  }

  test::TemporaryFolder folder_;
};

// The plug is pulled at every fourth write of a film: what was not synced is gone, whole files and names in folders.
// --resume then makes the film of a run that nothing disturbed, or starts anew where there was no checkpoint yet.
TEST_F(FailingCalls, APulledPlugLosesNothingThatACheckpointRestsOn) {
  const std::vector<std::string> film = {"render", "bar.toml",  "--quiet", "--no-images", "--checkpoint-every",
                                         "2",      "--threads", "1",       "--frames",    "9"};
  const std::filesystem::path out = folder_.path / "out" / "bar";
  ASSERT_EQ(test::run(folder_.path, film).status, 0);
  const std::string motion = test::read_file(out / "motion" / "bar.pc2");
  int resumed = 0;
  for (int at = 1;; at += 4) {
    SCOPED_TRACE(fmt::format("plug pulled at write {}", at));
    std::filesystem::remove_all(folder_.path / "out");
    ::setenv("FAILING_PLUG", "1", 1);
    const Result pulled = run_with("write", at, film);
    ::unsetenv("FAILING_PLUG");
    if (pulled.status == 0) break;
    EXPECT_EQ(pulled.status, 99) << pulled.err;
    std::vector<std::string> again = film;
    const bool had_checkpoint = std::filesystem::exists(out / "checkpoint" / "state");
    if (had_checkpoint) again.push_back("--resume");
    resumed += had_checkpoint;
    if (!had_checkpoint) std::filesystem::remove_all(folder_.path / "out");
    const Result result = test::run(folder_.path, again);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(test::read_file(out / "motion" / "bar.pc2"), motion);
    EXPECT_EQ(test::profile_of(out)["frames"].size(), 9u);
  }
  EXPECT_GE(resumed, 3);
}

const std::vector<std::string> film = {"render", "bar.toml",  "--quiet", "--no-video", "--checkpoint-every",
                                       "2",      "--threads", "1"};

TEST_F(FailingCalls, Open) { fail_each("open", film, 8); }
TEST_F(FailingCalls, Read) { fail_each("read", film, 1); }
TEST_F(FailingCalls, Write) { fail_each("write", film, 8); }
TEST_F(FailingCalls, Fsync) { fail_each("fsync", film, 8); }
TEST_F(FailingCalls, Rename) { fail_each("rename", film, 6); }

}  // namespace failing_calls_test
}  // namespace supple
