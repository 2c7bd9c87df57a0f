#include <fmt/core.h>

#include <algorithm>
#include <functional>

#include "app/bench/meeting_run.h"
#include "app/bench/sections.h"

namespace supple {
namespace {

using Outcomes = std::vector<MeetingOutcome>;

// Describes how the runs of a case ended: the first rule that was broken, how often, and whether a run told nothing of
// it.
std::string end_text(const Outcomes& outcomes) {
  const auto failed = std::ranges::count_if(outcomes, [](const MeetingOutcome& one) { return !one.passed_all(); });
  const auto silent = std::ranges::count_if(outcomes, &MeetingOutcome::is_silent);
  const bool warned = std::ranges::any_of(outcomes, [](const MeetingOutcome& one) { return !one.warnings.empty(); });
  if (failed == 0) return warned ? "(warns)" : "";
  const std::string first =
      std::ranges::find_if(outcomes, [](const MeetingOutcome& one) { return !one.passed_all(); })->failure;
  std::string text = outcomes.size() == 1 ? first : fmt::format("{} of {}: {}", failed, outcomes.size(), first);
  if (silent > 0) text += outcomes.size() == 1 ? "; silent" : fmt::format("; {} silent", silent);
  return text;
}

std::string figures_text(const Outcomes& outcomes) {
  double deepest = 0, deep_at_end = 0, gained = 0, speed = 0, trials = 0;
  for (const MeetingOutcome& one : outcomes) {
    deepest = std::max(deepest, one.deepest);
    deep_at_end = std::max(deep_at_end, one.depth_at_end);
    gained = std::max(gained, one.gained);
    speed = std::max(speed, one.speed);
    trials += one.trials / double(outcomes.size());
  }
  return fmt::format("{:.1e}; {:.1e}; {:.0e}; {:.0e}; {:.0f}", deepest, deep_at_end, gained, speed, trials);
}

MeetingTables empty_tables() {
  MeetingTables tables;
  tables.ends = {"stability-meeting", "What each case of bodies that meet ends as"};
  tables.ends.note =
      "An empty cell: all rules of the case are kept, and the run warns of nothing. In brackets: they are kept, and "
      "the run warns. Else: the first rule that is broken, and how many of those runs are silent, which means that "
      "they warn of nothing. docs/bench.md has the rules.";
  tables.figures = {"stability-meeting-figures", "Depths, energy, speed and evaluations where bodies meet"};
  tables.figures.note =
      "Each cell: how deep bodies were in each other, at most and at the end, over the smaller one's size; energy from "
      "nothing over what was exchanged; speed of the fastest body at the end, in its sizes a second; evaluations a "
      "frame. Of several runs the worst, and the mean of the evaluations.";
  for (ReportTable* table : {&tables.ends, &tables.figures}) {
    table->columns = {"case", "substeps"};
    for (const char* material : meeting_materials) table->columns.emplace_back(material);
  }
  return tables;
}

void count(const Outcomes& outcomes, MeetingCounts& counts) {
  counts.runs += int(outcomes.size());
  for (const MeetingOutcome& one : outcomes) {
    counts.failed += one.passed_all() ? 0 : 1;
    counts.silent += one.is_silent() ? 1 : 0;
  }
}

}  // namespace

MeetingTables meeting_tables(const BenchSetting& setting) {
  MeetingTables tables = empty_tables();
  const std::vector<NamedMaterial> materials = stability_materials();
  const std::filesystem::path folder = setting.out / "meeting-run";
  for (const MeetingCase& meeting : meeting_cases()) {
    for (const int substeps : meeting_substeps) {
      say_doing(setting, fmt::format("{}, {} substep{}", meeting.name, substeps, substeps == 1 ? "" : "s"));
      std::vector<std::string> ends = {meeting.name, std::to_string(substeps)}, figures = ends;
      for (const char* name : meeting_materials) {
        const auto material = std::ranges::find(materials, name, &NamedMaterial::name);
        const Outcomes outcomes = run_meeting(meeting, *material, substeps, folder, *setting.threads);
        count(outcomes, tables.counts);
        ends.push_back(end_text(outcomes));
        figures.push_back(figures_text(outcomes));
      }
      tables.ends.rows.push_back(std::move(ends));
      tables.figures.rows.push_back(std::move(figures));
    }
  }
  std::error_code ignored;  // what stays is overwritten the next time
  std::filesystem::remove_all(folder, ignored);
  return tables;
}

}  // namespace supple
