// Tests budgets of time from the command line: what a run notes of them, and runs that repeat it to the bit.
#include <gtest/gtest.h>

#include <fstream>

#include "output/run/profile.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace budget_test {

using test::Result;
using test::run;

class FilmWithBudget : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "bar.toml") << R"(frames = 6
substeps = 2
[solver]
iterations = 40
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
material = "jelly"
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
)";
  }
  Result film(const std::string& out, std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", "bar.toml", "--quiet", "--no-images", "--out", out});
    return run(folder_.path, more);
  }
  std::vector<FrameRow> rows(const std::string& out) const { return read_profile(folder_.path / out / "profile.json"); }
  static std::vector<std::uint64_t> hashes(const std::vector<FrameRow>& rows) {
    std::vector<std::uint64_t> result;
    for (const FrameRow& row : rows) result.push_back(row.state_hash);
    return result;
  }

  test::TemporaryFolder folder_;
};

TEST_F(FilmWithBudget, MakesOneIterationWhereNoMoreFitsAndNotesIt) {
  ASSERT_EQ(film("short", {"--set", "solver.budget_ms=1e-6"}).status, 0);
  for (const FrameRow& row : rows("short")) {
    const BodyRow& body = row.bodies.front();
    EXPECT_EQ(body.stop_reason, "budget");
    EXPECT_EQ(body.iterations, 2) << "one in each substep";
    const std::vector<std::array<int, 2>> one_each = {{1, -1}, {1, -1}};
    EXPECT_EQ(body.budget_cuts, one_each);
  }
}

TEST_F(FilmWithBudget, ChangesNothingWhereAllIterationsFit) {
  ASSERT_EQ(film("free", {}).status, 0);
  ASSERT_EQ(film("ample", {"--set", "solver.budget_ms=1e6"}).status, 0);
  EXPECT_EQ(hashes(rows("ample")), hashes(rows("free")));
  EXPECT_NE(rows("ample").front().bodies.front().stop_reason, "budget");
  EXPECT_TRUE(rows("free").front().bodies.front().budget_cuts.empty());
}

TEST_F(FilmWithBudget, IsRepeatedToTheBitWhateverTheClockSays) {
  ASSERT_EQ(film("free", {}).status, 0);
  ASSERT_EQ(film("short", {"--set", "solver.budget_ms=1e-6"}).status, 0);
  ASSERT_NE(hashes(rows("short")), hashes(rows("free")));
  for (const char* budget : {"1e-6", "1e6", "0"}) {
    const Result again = film("again", {"--repeat", "short", "--set", std::string("solver.budget_ms=") + budget});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(hashes(rows("again")), hashes(rows("short"))) << budget;
    EXPECT_EQ(rows("again").back().bodies.front().stop_reason, "budget");
  }
  ASSERT_EQ(film("twice", {"--repeat", "again", "--frames", "3"}).status, 0) << "a repeated run can be repeated";
}

// A body that is pressed nearly flat is finished by Newton's method, unless its steps have a budget of time.
TEST_F(FilmWithBudget, IsRepeatedToTheBitWhereOnlyOneBodyHasABudget) {
  std::ofstream(folder_.path / "bar.toml") << R"(frames = 3
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
material = "jelly"
solver = { budget_ms = 1e-6 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
[[body]]
name = "tangled"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
material = { model = "neo-hookean", young = 1e5, poisson = 0.4 }
start = { random = [0.4, 0.1, 0.1] }
contact = { meets = false }
)";
  ASSERT_EQ(film("first", {}).status, 0);
  ASSERT_GT(rows("first").front().bodies.back().newton_iterations, 0);
  ASSERT_EQ(film("again", {"--repeat", "first"}).status, 0);
  EXPECT_EQ(hashes(rows("again")), hashes(rows("first")));
  EXPECT_TRUE(rows("again").front().bodies.back().budget_cuts.empty());
}

TEST_F(FilmWithBudget, RefusesToRepeatARunThatHasNoCutsOrTooFewFrames) {
  ASSERT_EQ(film("free", {}).status, 0);
  const Result without = film("again", {"--repeat", "free"});
  EXPECT_EQ(without.status, 2);
  EXPECT_NE(without.err.find("solver.budget_ms"), std::string::npos) << without.err;
  ASSERT_EQ(film("short", {"--set", "solver.budget_ms=1e-6"}).status, 0);
  const Result longer = film("again", {"--repeat", "short", "--frames", "9"});
  EXPECT_EQ(longer.status, 2);
  EXPECT_NE(longer.err.find("has 6 frames"), std::string::npos) << longer.err;
  EXPECT_EQ(film("again", {"--repeat", "nowhere"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_.path / "again")) << "a film that is refused leaves no trace";
}

}  // namespace budget_test
}  // namespace supple
