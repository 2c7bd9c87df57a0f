// Tests jobs, for which a program starts itself, and the records of their outcomes. The program is here that of the
// tests: it lists its tests and ends. Sweeps and galleries test jobs that fail and that are interrupted.
#include "app/jobs.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "output/files/json_text.h"
#include "support/bodies.h"

namespace supple {
namespace jobs_test {

Job listing(const std::filesystem::path& record = {}) {
  return {{"--gtest_list_tests", "--gtest_filter=Jobs.EachEndsOnce*"}, record};
}

TEST(Jobs, EachEndsOnceAndIsToldOf) {
  std::set<std::size_t> told;
  std::vector<std::size_t> ended;
  const auto on_ended = [&](const JobEnd& end) {
    told.insert(end.job);
    ended.push_back(end.ended);
    EXPECT_EQ(end.status, 0);
    EXPECT_EQ(end.how, "ended with status 0");
    EXPECT_NE(end.output.find("EachEndsOnceAndIsToldOf"), std::string::npos) << end.output;
    EXPECT_FALSE(end.cut_short);
  };
  run_jobs({"listing", 5, 2, [](std::size_t) { return listing(); }, on_ended});
  EXPECT_EQ(told, (std::set<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(ended, (std::vector<std::size_t>{1, 2, 3, 4, 5}));
}

TEST(Jobs, TheRecordOfAnEarlierTimeIsRemoved) {
  const test::TemporaryFolder folder;
  const std::filesystem::path record = folder.path / "record.json";
  std::ofstream(record) << "{}";
  run_jobs({"listing", 1, 1, [&](std::size_t) { return listing(record); },
            [&](const JobEnd&) { EXPECT_FALSE(std::filesystem::exists(record)); }});
}

TEST(Jobs, AnErrorStartsNoMore) {
  int ended = 0;
  const auto on_ended = [&](const JobEnd&) {
    ++ended;
    throw InputError("record", "cannot be kept");
  };
  EXPECT_THROW(run_jobs({"listing", 5, 1, [](std::size_t) { return listing(); }, on_ended}), InputError);
  EXPECT_EQ(ended, 1);
}

TEST(JobRecord, SaysWhatTheJobWasMadeWithAndHowItEnded) {
  using Json = nlohmann::ordered_json;
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "new" / "record.json";
  const Json made_with = {{"identity", "17"}};
  write_job_record(file, made_with, {2, "no such file"});
  EXPECT_EQ(test::read_file(file),
            "{\n \"identity\": \"17\",\n \"exit_status\": 2,\n \"message\": \"no such file\"\n}\n");
  EXPECT_EQ(outcome_in(json_object_in<Json>(file)).exit_status, 2);
  EXPECT_FALSE(outcome_in(json_object_in<Json>(file)).wall_s);
  write_job_record(file, made_with, {0, "", 1.5});
  EXPECT_EQ(outcome_in(json_object_in<Json>(file)).wall_s, 1.5);
  std::ofstream(file) << "[1, 2]";
  EXPECT_TRUE(json_object_in<Json>(file).is_null());
  EXPECT_TRUE(json_object_in<Json>(folder.path / "none").is_null());
  EXPECT_EQ(outcome_in(Json::object()).exit_status, 1) << "a record without an outcome does not count as done";
}

}  // namespace jobs_test
}  // namespace supple
