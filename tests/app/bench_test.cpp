// Tests the parts of `supple bench`, and the program itself on its shortest benchmark.
#include "app/bench/sections.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "app/bench/section_file.h"
#include "app/bench/touching_film.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace bench_test {

using test::TemporaryFolder;

TEST(Bench, StatesComeBackFromTheirFilesWithTheSameBits) {
  const TemporaryFolder folder;
  Subject subject({"shaking-bar", "bar"});
  Threads threads(1);
  const std::vector<BenchState> played = states_of(subject, {3, 17}, folder.path, threads);
  const std::vector<BenchState> read = states_of(subject, {3, 17}, folder.path, threads);
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(played[i].hash, read[i].hash);
    EXPECT_TRUE(played[i].before.x == read[i].before.x && played[i].before.v == read[i].before.v);
    EXPECT_EQ(played[i].before.time, read[i].before.time);
  }
  EXPECT_NE(read[0].hash, read[1].hash);
}

TEST(Bench, GainsByIterationAddUpToWhereTheMethodsEnd) {
  const TemporaryFolder folder;
  Subject subject({"shaking-bar", "bar"});
  Threads threads(1);
  SolverComparison comparison(subject, threads);
  const BenchState state = states_of(subject, {25}, folder.path, threads).front();
  const std::vector<Outcome> outcomes =
      comparison.run(state, {{"ours", Method::quasi_newton, 8}, {"Newton", Method::newton, 40}}, 1);
  const Minimum lowest = comparison.reference(state, outcomes);
  EXPECT_TRUE(lowest.positive_definite);
  OpenWorkspace w;
  for (const Outcome& outcome : outcomes) {
    ASSERT_FALSE(outcome.failed);
    ASSERT_EQ(outcome.gained.size(), outcome.ms.size());
    EXPECT_NEAR(outcome.gained.back(), gained(subject.model(), subject.inputs(state), state.before, outcome.x, w),
                1e-12 * lowest.below_y);
    const std::vector<double> errors = errors_of(outcome, lowest.below_y);
    for (std::size_t k = 1; k < errors.size(); ++k) {
      EXPECT_LE(errors[k], errors[k - 1] + 1e-14);
      EXPECT_GE(outcome.ms[k], outcome.ms[k - 1]);
    }
    EXPECT_EQ(time_to(outcome, lowest.below_y, errors.front()), outcome.ms.front());
    EXPECT_EQ(time_to(outcome, lowest.below_y, -1), std::numeric_limits<double>::infinity());
  }
  EXPECT_LT(errors_of(outcomes[1], lowest.below_y).back(), 1e-12);
}

TEST(Bench, TheReferenceIsBelowEveryMethodsEnd) {
  const TemporaryFolder folder;
  Subject subject({"spline-spheres", "a"});
  Threads threads(1);
  SolverComparison comparison(subject, threads);
  const BenchState state = states_of(subject, {20}, folder.path, threads).front();
  std::vector<SolverEntry> entries;
  for (const Method& method : compared_methods()) entries.push_back({name_of(method), method, 40});
  const std::vector<Outcome> outcomes = comparison.run(state, entries, 0);
  const Minimum lowest = comparison.reference(state, outcomes);
  for (const Outcome& outcome : outcomes) {
    if (outcome.failed) continue;
    EXPECT_LE(outcome.gained.back(), lowest.below_y * (1 + 1e-12)) << outcome.label;
  }
}

TEST(Bench, SectionsSurviveTheirFiles) {
  const TemporaryFolder folder;
  ReportSection section{"name", "Heading", "Text with \"quotes\""};
  section.tables.push_back({"t", "T", "note", {"a", "b"}, {{"1", "x, y"}}, {"b"}});
  ReportPlot plot{"p", "P"};
  plot.style = ReportPlot::Style::steps;
  plot.log_x = true;
  plot.x_max = 7;
  plot.series.push_back({"s", {1, std::numeric_limits<double>::infinity()}, {2, std::nan("")}, true});
  section.plots.push_back(plot);
  write_section(section, "this machine", folder.path / "s.json");
  const auto back = read_section(folder.path / "s.json", "this machine");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->text, section.text);
  EXPECT_EQ(back->tables[0].rows, section.tables[0].rows);
  EXPECT_EQ(back->plots[0].x_max, 7);
  EXPECT_EQ(back->plots[0].style, ReportPlot::Style::steps);
  EXPECT_TRUE(std::isinf(back->plots[0].series[0].x[1]) && std::isnan(back->plots[0].series[0].y[1]));
  EXPECT_TRUE(back->plots[0].series[0].thick);
  EXPECT_FALSE(read_section(folder.path / "s.json", "another machine"));
  EXPECT_FALSE(read_section(folder.path / "none.json", "this machine"));
}

TEST(Bench, FilmsOfTouchingBodiesCountAStepOfSeveralBodiesOnce) {
  const auto cube = [](const char* name, double x) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }}\nmaterial = \"rubber\"\n"
        "position = [{:g}, 0, 0]\nvelocity = [{:g}, 0, 0]\n",
        name, x, -4 * x);
  };
  Threads threads(1);
  TouchingFilm film("gravity = [0, 0, 0]\n" + cube("left", -0.11) + cube("right", 0.11), threads);
  const double before = film.momentum(0).norm();
  ASSERT_TRUE(film.play());
  EXPECT_EQ(film.work().largest_island, 2u);
  EXPECT_EQ(film.work().iterations, film.world().body(0).report().iterations);
  EXPECT_GT(film.work().iterations, 0);
  EXPECT_LT(film.momentum().norm(), 1e-12 * before);
  EXPECT_EQ(film.frames(), 1);
}

TEST(Bench, RanksAreTheNearestOnes) {
  EXPECT_EQ(rank_of({3, 1, 2, 4}, 0.5), 2);
  EXPECT_EQ(rank_of({3, 1, 2, 4}, 0.99), 4);
  EXPECT_EQ(rank_of({3, 1, 2, 4}, 1), 4);
  EXPECT_TRUE(std::isnan(rank_of({}, 0.5)));
}

// Both methods run at the default ten iterations, with the default delay and radius.
TEST(Bench, ChebyshevIsNearerToTheMinimumThanProjectiveDynamicsOnTheTwistingBar) {
  const TemporaryFolder folder;
  Subject subject({"twisting-bar", "bar", {"body.bar.box.cells=[14, 5, 5]"}});
  Threads threads(1);
  SolverComparison comparison(subject, threads);
  for (const BenchState& state : states_of(subject, {40, 70, 100}, folder.path, threads)) {
    const std::vector<Outcome> outcomes = comparison.run(
        state, {{"chebyshev", Method::chebyshev}, {"projective dynamics", Method::projective_dynamics}}, 0);
    EXPECT_GT((outcomes[0].x - outcomes[1].x).cwiseAbs().maxCoeff(), 0);
    const double whole = comparison.reference(state, outcomes).below_y;
    EXPECT_LT(last_error(outcomes[0], whole), 0.8 * last_error(outcomes[1], whole)) << "frame " << state.frame;
  }
}

// Table II shows that our matrix does not depend on the rotation of a body, and that the rest pose's does.
TEST(Bench, Table2IsTheSameInBothPosesForOursAlone) {
  const TemporaryFolder folder;
  Threads threads(1);
  const ReportSection section = bench_table2({folder.path, std::nullopt, &threads});
  const auto number = [&](std::size_t row) { return std::stod(section.tables[0].rows[row][2]); };
  EXPECT_NEAR(number(2), number(3), 1e-6 * number(2));
  EXPECT_GT(number(1), 5 * number(0));
}

TEST(BenchProgram, LeavesAPageAndGoesOnWhereItStopped) {
  const TemporaryFolder folder;
  const std::string out = (folder.path / "report").string();
  const test::Result first = test::run(folder.path, {"bench", "table2", "--out", out});
  ASSERT_EQ(first.status, 0) << first.err;
  for (const char* name : {"index.html", "table2.csv", "table2.json", "figure9.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder.path / "report" / name)) << name;
  const auto csv = read_csv(folder.path / "report" / "table2.csv");
  const std::string page = test::read_file(folder.path / "report" / "index.html");
  for (std::size_t row = 1; row < csv.size(); ++row) EXPECT_NE(page.find(csv[row][3]), std::string::npos);
  const test::Result again = test::run(folder.path, {"bench", "table2", "--out", out});
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("finished before"), std::string::npos) << again.err;
}

TEST(BenchProgram, RefusesWhatItCannotRun) {
  const TemporaryFolder folder;
  EXPECT_EQ(test::run(folder.path, {"bench", "figure99"}).status, 2);
  const test::Result meshes = test::run(folder.path, {"bench", "table2", "--paper-meshes", "/nowhere"});
  EXPECT_EQ(meshes.status, 2);
  EXPECT_NE(meshes.err.find("/nowhere"), std::string::npos);
}

// ./run demo builds the program of films alone.
TEST(BenchProgram, SaysWhatToBuildWhereItIsMissing) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(test::program_name, folder.path / "supple");
  const std::string command = "cd '" + folder.path.string() + "' && ./supple bench table2 2> said.txt";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_EQ(test::read_file(folder.path / "said.txt"),
            "supple: bench: its program, supple-bench, has not been built: cmake --build build/release\n");
}

}  // namespace bench_test
}  // namespace supple
