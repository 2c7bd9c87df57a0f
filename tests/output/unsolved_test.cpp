// Tests the line that names frames whose steps were not solved.
#include "output/run/row_tally.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace unsolved_test {

FrameRow row_of(int frame, double estimate, int iterations, int trials) {
  FrameRow row;
  row.frame = frame;
  BodyRow body;
  body.name = "bar";
  body.error_estimate = estimate;
  body.iterations = iterations;
  body.line_search = trials;
  body.unsolved = is_unsolved(estimate, iterations, trials);
  row.bodies = {body};
  return row;
}

std::string unsolved_of(const std::vector<FrameRow>& rows) { return RowTally(rows).unsolved_warning(); }
const std::string remedy = "; more solver.iterations bring them nearer";

TEST(Unsolved, NamesTheWorstFrameOfEachBody) {
  std::vector<FrameRow> rows = {row_of(0, 1e-5, 10, 10), row_of(1, 0.3, 10, 12), row_of(2, 0.63, 10, 15),
                                row_of(3, 0.1, 10, 40)};
  rows[2].bodies[0].motion_estimate = 0.2;
  EXPECT_EQ(
      unsolved_of(rows),
      "2 of 4 frames did not come near their solution: body 'bar' by about 0.2 of a step's motion, which is seen where "
      "it moves fast (frame 2)" +
          remedy);
  rows[2].bodies[0].motion_estimate = 0.05;
  EXPECT_EQ(unsolved_of(rows),
            "2 of 4 frames did not come near their solution: body 'bar' by too little to be seen (frame 2)" + remedy);
  rows[2].bodies[0].motion_estimate = 15;
  EXPECT_EQ(
      unsolved_of(rows),
      "2 of 4 frames did not come near their solution: body 'bar' by more than a step's motion, which is seen where it "
      "moves fast (frame 2)" +
          remedy);
  rows[2].bodies[0].motion_estimate = 0;  // not known
  EXPECT_EQ(
      unsolved_of(rows),
      "2 of 4 frames did not come near their solution: body 'bar' with an error of about 0.63 in energy (frame 2)" +
          remedy);
  RowTally meant(rows);
  meant.set_unsolved_words({.meant = {"bar"}});
  EXPECT_EQ(meant.unsolved_warning(), "");
  rows[0].bodies[0].motion_estimate = 0.3;
  rows[0].bodies[0].unsolved = is_unsolved(std::max(1e-5, 0.3), 10, 10);
  EXPECT_TRUE(unsolved_of(rows).starts_with("3 of 4 frames"));
  rows[0].bodies[0].unsolved = false;
  rows[3].bodies[0].unsolved = true;
  ASSERT_EQ(RowTally(rows).unsolved().size(), 3u);
  EXPECT_EQ(RowTally(rows).unsolved()[2].frame, 3);
  const auto json = nlohmann::json::parse(profile_json(rows));
  EXPECT_EQ(json["summary"]["warnings"], nlohmann::json::array({unsolved_of(rows)}));
  ASSERT_EQ(json["summary"]["unsolved"].size(), 3u);
  EXPECT_EQ(json["summary"]["unsolved"][1]["frame"], 2);
  EXPECT_EQ(json["summary"]["unsolved"][1]["body"], "bar");
  EXPECT_EQ(json["summary"]["unsolved"][1]["error_estimate"], 0.63);
}

// A body that has iterations of its own is not helped by the scene's, and the other way round.
TEST(Unsolved, NamesTheOptionsOfTheBodiesThatNeedThem) {
  FrameRow row = row_of(0, 0.3, 10, 12);
  row.bodies.push_back(row.bodies[0]);
  row.bodies[1].name = "ball";
  const auto warning = [&] {
    RowTally tally({row});
    tally.set_unsolved_words({.options = {{"bar", "--set solver.iterations=30"}, {"ball", "--set own=60"}}});
    return tally.unsolved_warning();
  };
  EXPECT_TRUE(warning().ends_with("; --set solver.iterations=30 --set own=60 bring them nearer")) << warning();
  row.bodies[1].name = "bar";
  EXPECT_TRUE(warning().ends_with("; --set solver.iterations=30 brings them nearer")) << warning();
  row.bodies[1].name = "ball";
  row.bodies[0].unsolved = false;
  EXPECT_TRUE(warning().ends_with("; --set own=60 brings them nearer")) << warning();
}

TEST(Unsolved, SaysNothingOfAFilmThatIsSolved) {
  const std::vector<FrameRow> rows = {row_of(0, 1e-5, 10, 10), row_of(1, 0, 0, 0), row_of(2, 0, 0, 1)};
  EXPECT_EQ(unsolved_of(rows), "");
  EXPECT_EQ(unsolved_of({}), "");
  EXPECT_FALSE(nlohmann::json::parse(profile_json(rows))["summary"].contains("unsolved"));
}

// Cubes that slide off a slope land on the ground, where contacts are found in the middle of a step and raise g. The
// errors of these steps are below 0.01, and were estimated as 1.
TEST(Unsolved, SaysNothingOfStepsWhoseContactsAreFoundOnTheWay) {
  const test::TemporaryFolder folder;
  const test::Result film = test::run(folder.path, {"render", "slopes", "--frames", "56", "--no-images", "--quiet",
                                                    "--error-every", "7", "--out", "slopes"});
  ASSERT_EQ(film.status, 0) << film.err;
  int measured = 0;
  for (const FrameRow& row : read_profile(folder.path / "slopes" / "profile.json")) {
    for (const BodyRow& body : row.bodies) {
      EXPECT_LT(body.error_estimate, 0.1) << body.name << " in frame " << row.frame;
      if (!body.error_measured) continue;
      EXPECT_LT(std::abs(body.error.value_or(0)), 0.01) << body.name << " in frame " << row.frame;
      ++measured;
    }
  }
  EXPECT_GE(measured, 20);
}

}  // namespace unsolved_test
}  // namespace supple
