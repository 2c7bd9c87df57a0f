// The rows of a film go to its folder as they come, and come back from there.
#include "film/record/film_log.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <fstream>

#include "base/error.h"
#include "output/run/row_tally.h"
#include "support/bodies.h"

namespace supple {
namespace film_log_test {

FrameRow row_of(int frame) {
  FrameRow row;
  row.frame = frame;
  row.step_ms = frame % 7;
  row.state_hash = std::uint64_t(frame) << 40;
  row.bodies.resize(2);
  for (BodyRow& body : row.bodies) {
    body.name = "a body with a name that does not fit into a short string";
    body.stop_reason = "iterations";
    body.error_estimate = frame == 17 ? 0.5 : 1e-3;
    body.unsolved = frame == 17;
    body.iterations = body.line_search = 10;
    body.balance = BalanceRow{1, 2, frame == 30 ? 8.0 : 0.0, 10};
  }
  return row;
}

long bytes_in_use() { return long(mallinfo2().uordblks + mallinfo2().hblkhd); }

TEST(FilmLog, MemoryDoesNotGrowWithTheNumberOfFrames) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder.path / "run");
  for (const int every : {0, 1000000}) {
    FilmLog log(run, every, "{}", 0, {});
    long early = 0;
    for (int frame = 0; frame < 5000; ++frame) {
      log.add(row_of(frame));
      log.settle({});
      ASSERT_EQ(log.waiting_rows(), 0);
      if (frame == 500) early = bytes_in_use();
    }
    EXPECT_LT(bytes_in_use() - early, 10000);  // the rows themselves would be two megabytes
    EXPECT_EQ(log.frames(), 5000);
    EXPECT_EQ(log.whole(), 5000);
    EXPECT_EQ(std::filesystem::exists(run.rows()), every > 0);  // without checkpoints, nobody reads it later
  }
}

TEST(FilmLog, RowsComeBackAsTheyWere) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder.path / "run");
  std::vector<FrameRow> rows;
  FrameRows kept;
  {
    FilmLog log(run, 0, "{}", 0, {});
    for (int frame = 0; frame < 300; ++frame) {
      rows.push_back(row_of(frame));
      log.add(row_of(frame));
    }
    EXPECT_EQ(log.waiting_rows(), 300);
    log.settle({});
    kept = log.whole_rows();
  }
  RowTally tally;
  kept.each([&](const FrameRow& row) { tally.add(row); });
  std::string text;
  write_profile(kept, tally, "", [&text](std::string_view piece) { text += piece; });
  EXPECT_EQ(text, profile_json(rows));
  EXPECT_EQ(tally.table(), profile_table(rows));
  EXPECT_EQ(tally.last_hash(), rows.back().state_hash);
  ASSERT_EQ(tally.warnings().size(), 3u);
  EXPECT_TRUE(
      tally.warnings()[0].ends_with("first in frame 30: up to 8 J in frame 30, 80 % of what it exchanged; more "
                                    "solver.iterations or substeps, or a stiffer material"));
  EXPECT_TRUE(tally.warnings()[2].starts_with("1 of 300 frames did not come near their solution:"));
}

TEST(FilmLog, AFileThatLostRowsIsNamed) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder.path / "run");
  FilmLog log(run, 1000, "{}", 0, {});
  for (int frame = 0; frame < 3; ++frame) log.add(row_of(frame));
  log.settle({});
  const FrameRows rows = log.whole_rows();
  std::filesystem::resize_file(run.rows(), 100);
  try {
    rows.each([](const FrameRow&) {});
    FAIL();
  } catch (const RunError& error) {
    EXPECT_EQ(std::string(error.what()), run.rows().string() + ": has fewer rows than were written");
  }
}

}  // namespace film_log_test
}  // namespace supple
