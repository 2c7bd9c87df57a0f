// Tests what a film records and tells of bodies that overlap at the start: it says that they are still coming apart, that
// they have not come apart by the end, or that contact does not find them.
#include "film/record/pair_recorder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "baselines/make_rule.h"
#include "output/run/row_tally.h"
#include "support/scene_text.h"

namespace supple {
namespace pair_recorder_test {

// Two cubes, the second of which reaches 0.05 m into the first.
std::string overlapping(const std::string& keys = "") {
  const auto cube = [&](const char* name, int cells, const char* place) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [{}, {}, {}] }}\nmaterial = \"rubber\"\n"
        "position = {}\n{}\n",
        name, cells, cells, cells, place, keys);
  };
  return "gravity = [0, 0, 0]\n" + cube("first", 3, "[0, 0, 0]") + cube("second", 4, "[0.15, 0.02, 0.03]");
}

struct Recorded {
  explicit Recorded(const std::string& text)
      : threads(1), world(test::scene_of(text), assemble(test::scene_of(text))), pairs(world, FrameRows()) {
    world.start({make_rule, settings_of}, &threads);
  }
  FrameRow record(int frame) {
    FrameRow row;
    row.frame = frame;
    pairs.record(row);
    return row;
  }

  Threads threads;
  World world;
  PairRecorder pairs;
};

FrameRow row_with(int frame, double depth, bool coming_apart) {
  FrameRow row;
  row.frame = frame;
  row.pairs.push_back({{"first", "second"}, 3, depth, 1, coming_apart, coming_apart});
  return row;
}

TEST(PairRecorder, SaysOfAnOverlapAtTheStartThatItIsComingApart) {
  Recorded recorded(overlapping());
  ASSERT_TRUE(recorded.world.play(0));
  const FrameRow row = recorded.record(0);
  ASSERT_EQ(row.pairs.size(), 1u);
  EXPECT_GT(row.pairs.front().penetration, DeepBodies::deep);
  EXPECT_TRUE(row.pairs.front().coming_apart);
  EXPECT_TRUE(row.pairs.front().expected);
  EXPECT_TRUE(row.deep.empty());
}

TEST(PairRecorder, SaysNothingOfAnOverlapAtTheStartThatIsMeant) {
  Recorded recorded(overlapping("meant = [\"overlap\"]"));
  ASSERT_TRUE(recorded.world.play(0));
  const FrameRow row = recorded.record(0);
  ASSERT_EQ(row.pairs.size(), 1u);
  EXPECT_FALSE(row.pairs.front().coming_apart);
  EXPECT_TRUE(row.pairs.front().expected);
}

// No step is made, so that there are no contacts.
TEST(PairRecorder, FindsAnOverlapAtTheStartThatHasNoContacts) {
  Recorded recorded(overlapping());
  const FrameRow row = recorded.record(0);
  EXPECT_TRUE(row.pairs.empty());
  ASSERT_EQ(row.deep.size(), 1u);
  EXPECT_GT(row.deep.front().share, 0.1);
  EXPECT_TRUE(recorded.record(1).deep.empty()) << "it is told once";
  EXPECT_TRUE(Recorded(overlapping("meant = [\"overlap\"]")).record(0).deep.empty());
}

TEST(PairRecorder, FindsTheSameAfterAnEarlierRun) {
  Recorded recorded(overlapping());
  FrameRow first;  // of a frame without contacts, and without this finding
  const std::vector<FrameRow> rows = {first};
  PairRecorder resumed(recorded.world, FrameRows(rows));
  FrameRow row;
  resumed.record(row);
  EXPECT_EQ(row.deep.size(), 1u);
  const std::vector<FrameRow> told = {recorded.record(0)};
  PairRecorder again(recorded.world, FrameRows(told));
  FrameRow later;
  again.record(later);
  EXPECT_TRUE(later.deep.empty()) << "the earlier run has told it";
}

TEST(RowTally, TellsOfBodiesThatHaveNotComeApartByTheLastFrame) {
  RowTally tally;
  tally.add(row_with(0, 0.2, true));
  tally.add(row_with(1, 0.13, true));
  EXPECT_EQ(tally.warnings(),
            std::vector<std::string>{
                "bodies 'first' and 'second' overlapped at the start and have not come apart: in the last frame, 1, 13 "
                "% of the smaller one's size is left; more frames or a larger solver.contact.push_out may part them"});
  tally.add(row_with(2, 0.005, false));
  EXPECT_TRUE(tally.warnings().empty());
}

TEST(RowTally, TellsNothingOfBodiesThatNoLongerTouchInTheLastFrame) {
  RowTally tally;
  tally.add(row_with(0, 0.2, true));
  FrameRow row;
  row.frame = 1;
  tally.add(row);
  EXPECT_TRUE(tally.warnings().empty());
}

}  // namespace pair_recorder_test
}  // namespace supple
