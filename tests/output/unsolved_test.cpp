// Tests the line that names frames whose steps were not solved.
#include "output/unsolved.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace supple {
namespace {

FrameRow row_of(int frame, double estimate, int iterations, int trials) {
  FrameRow row;
  row.frame = frame;
  BodyRow body;
  body.name = "bar";
  body.error_estimate = estimate;
  body.iterations = iterations;
  body.line_search = trials;
  row.bodies = {body};
  return row;
}

TEST(Unsolved, NamesTheWorstFrameOfEachBody) {
  std::vector<FrameRow> rows = {row_of(0, 1e-5, 10, 10), row_of(1, 0.3, 10, 12), row_of(2, 0.63, 10, 15),
                                row_of(3, 0.1, 10, 40)};
  EXPECT_EQ(unsolved_text(rows),
            "2 of 4 frames did not come near their solution: body 'bar' worst in frame 2, with an error of about 0.63 "
            "and 1.5 trials an iteration; more iterations or substeps help");
  rows[3].bodies[0].line_search = 41;
  ASSERT_EQ(unsolved_steps(rows).size(), 3u);
  EXPECT_EQ(unsolved_steps(rows)[2].frame, 3);
  const auto json = nlohmann::json::parse(profile_json(rows));
  ASSERT_EQ(json["summary"]["unsolved"].size(), 3u);
  EXPECT_EQ(json["summary"]["unsolved"][1]["frame"], 2);
  EXPECT_EQ(json["summary"]["unsolved"][1]["body"], "bar");
  EXPECT_EQ(json["summary"]["unsolved"][1]["error_estimate"], 0.63);
}

TEST(Unsolved, SaysNothingOfAFilmThatIsSolved) {
  const std::vector<FrameRow> rows = {row_of(0, 1e-5, 10, 10), row_of(1, 0, 0, 0)};
  EXPECT_EQ(unsolved_text(rows), "");
  EXPECT_EQ(unsolved_text({}), "");
  EXPECT_FALSE(nlohmann::json::parse(profile_json(rows))["summary"].contains("unsolved"));
}

}  // namespace
}  // namespace supple
