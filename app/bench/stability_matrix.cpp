#include "app/bench/stability_matrix.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/bench/meeting_run.h"
#include "app/bench/sections.h"
#include "app/bench/small_picture.h"

namespace supple {
namespace {

constexpr int panel_edge = 104;  // [pixels]

const char* rule_name(StableEnd end) {
  switch (end) {
    case StableEnd::recovered: return "at rest";
    case StableEnd::whole: return "whole";
    case StableEnd::bounded: break;
  }
  return "bounded";
}

// Describes in a cell how the runs of a case ended: the first rule that was broken, or what a run warns of.
std::string text_of(const std::vector<StabilityOutcome>& outcomes) {
  const auto broken = [](const StabilityOutcome& outcome) { return !outcome.passed(); };
  if (const auto count = std::count_if(outcomes.begin(), outcomes.end(), broken); count > 0) {
    const std::string first = std::find_if(outcomes.begin(), outcomes.end(), broken)->failure;
    return outcomes.size() == 1 ? first : fmt::format("{} of {}: {}", count, outcomes.size(), first);
  }
  int inverted = 0, collapsed = 0;
  for (const StabilityOutcome& outcome : outcomes) {
    inverted = std::max(inverted, outcome.inverted);
    collapsed = std::max(collapsed, outcome.collapsed);
  }
  if (inverted > 0) return fmt::format("({} inverted)", inverted);
  return collapsed > 0 ? fmt::format("({} without volume)", collapsed) : "";
}

std::string cost_text(const std::vector<StabilityOutcome>& outcomes) {
  double trials = 0, error = 0, apart = 0, volume = 0;
  for (const StabilityOutcome& outcome : outcomes) {
    trials += outcome.trials / double(outcomes.size());
    error = std::max(error, outcome.error_estimate);
    apart = std::max(apart, outcome.turned_apart);
    volume = std::max(volume, outcome.volume_change);
  }
  std::string text = fmt::format("{:.0f}; {:.1e}", trials, error);
  if (apart > 0) text += fmt::format("; {:.1e} apart", apart);
  if (volume > 0) text += fmt::format("; volume {:.1e}", volume);
  return text;
}

std::string errors_text(const std::vector<StabilityOutcome>& outcomes) {
  if (outcomes.empty() || !outcomes.front().errors) return "-";
  const auto number = [](const std::optional<double>& error) {
    if (!error) return std::string("-");
    return *error < 1e-9 ? std::string("0") : fmt::format("{:.0e}", *error);
  };
  const TabledErrors& errors = *outcomes.front().errors;
  std::string text;
  for (const auto& error : errors.ours) text += number(error) + " ";
  return text + "| " + number(errors.newton);
}

// Draws the start of the first run, and its end with each material.
void draw_case(const std::vector<std::vector<StabilityOutcome>>& by_material, const std::filesystem::path& file) {
  PanelPicture picture(int(by_material.size()) + 1, panel_edge);
  bool started = false;
  for (std::size_t m = 0; m < by_material.size(); ++m) {
    if (by_material[m].empty()) continue;
    const StabilityOutcome& outcome = by_material[m].front();
    if (!std::exchange(started, true)) picture.draw(0, outcome.start, outcome.surface, bounds_of(outcome.start));
    picture.draw(int(m) + 1, outcome.end, outcome.surface, bounds_of(outcome.end));
  }
  picture.write(file);
}

// Counts, for each material, how many runs of the starts come to rest, whatever their rule: without and with
// untangling.
class Returns {
 public:
  Returns(const std::vector<NamedMaterial>& materials, Threads& threads)
      : materials_(materials), threads_(threads), plain_(materials.size()), untangled_(materials.size()) {}

  // outcomes: the outcomes of the case's runs with one material
  void add(const HardCase& hard, std::size_t material, const std::vector<StabilityOutcome>& outcomes) {
    if (!hard.is_start) return;
    HardCase mended = hard;
    mended.scene += "[solver]\nuntangle = true\n";
    runs_ += material == 0 ? int(outcomes.size()) : 0;
    for (const StabilityOutcome& outcome : outcomes) plain_[material] += outcome.is_at_rest() ? 1 : 0;
    for (const StabilityOutcome& outcome : run_case(mended, materials_[material], threads_))
      untangled_[material] += outcome.is_at_rest() ? 1 : 0;
  }

  ReportTable table() const {
    ReportTable table{"stability-returns", "How many of the starts come to rest"};
    table.note =
        "Of all starts without gravity, whatever their rule: runs that end with nothing inverted or without volume and "
        "no stretch above 1.06, as they are and with solver.untangle.";
    table.columns = {"material", "starts", "at rest", "at rest, untangled"};
    for (std::size_t m = 0; m < materials_.size(); ++m)
      table.rows.push_back(
          {materials_[m].name, std::to_string(runs_), std::to_string(plain_[m]), std::to_string(untangled_[m])});
    return table;
  }

 private:
  const std::vector<NamedMaterial>& materials_;
  Threads& threads_;
  int runs_ = 0;
  std::vector<int> plain_, untangled_;
};

struct Counts {
  int runs = 0, passed = 0, silent = 0;
  void add(const std::vector<StabilityOutcome>& outcomes) {
    for (const StabilityOutcome& outcome : outcomes) {
      ++runs;
      passed += outcome.passed() ? 1 : 0;
      silent += !outcome.passed() && !outcome.told ? 1 : 0;
    }
  }
};

// Holds the three tables of the section, which have the same columns.
struct Tables {
  ReportTable ends{"stability", "What each case ends as"};
  ReportTable errors{"stability-errors", "Error of the worst step after 10, 50 and 200 iterations, and by Newton"};
  ReportTable work{"stability-work", "Evaluations a frame, and the worst error estimate"};
};

Tables tables_for(const std::vector<NamedMaterial>& materials) {
  Tables tables;
  tables.ends.note =
      "An empty cell: the rule of the case is kept, and nothing is inverted or without volume at the end. In brackets: "
      "the rule is kept, and the run warns. Without brackets: the rule that is broken. A dash: not played, because the "
      "case is about one material, or this one has no such Poisson's ratio. docs/stability.md has the rules.";
  tables.errors.note =
      "Equation 12 for the step with the largest error estimate of the case's first run, against the lowest minimum "
      "that Newton's method finds from any of the four ends. The fourth number is the error of 50 iterations of "
      "Newton's method. A number that stays large where Newton's is small: ours stalls. Two large ones: there are "
      "several minima, and Newton's method ends in another one.";
  tables.work.note =
      "Of turned copies, how far they are from the first one, turned back, over the body's size; of cases that must "
      "keep their volume, its largest change.";
  for (ReportTable* table : {&tables.ends, &tables.errors, &tables.work}) {
    table->columns = {"case", "rule"};
    for (const NamedMaterial& material : materials) table->columns.push_back(material.name);
  }
  return tables;
}

}  // namespace

ReportSection bench_stability(const BenchSetting& setting) {
  ReportSection section{"stability", "Hard cases: what every material makes of them"};
  const std::vector<NamedMaterial> materials = stability_materials();
  Tables tables = tables_for(materials);
  Counts counts;
  Returns returns(materials, *setting.threads);
  int number = 0;
  for (const HardCase& hard : hard_cases(setting.paper_meshes)) {
    say_doing(setting, hard.name);
    std::vector<std::vector<StabilityOutcome>> by_material;
    for (const NamedMaterial& material : materials) {
      const bool left_out = !hard.only.empty() && material.name != "neo-hookean";
      by_material.push_back(left_out ? std::vector<StabilityOutcome>()
                                     : run_case(hard, material, *setting.threads, true));
      counts.add(by_material.back());
      returns.add(hard, by_material.size() - 1, by_material.back());
    }
    const auto add_row = [&](ReportTable& table, const std::function<std::string(std::size_t)>& cell) {
      table.rows.push_back({hard.name, rule_name(hard.end)});
      for (std::size_t m = 0; m < materials.size(); ++m)
        table.rows.back().push_back(by_material[m].empty() ? "-" : cell(m));
    };
    add_row(tables.ends, [&](std::size_t m) { return text_of(by_material[m]); });
    add_row(tables.errors, [&](std::size_t m) { return errors_text(by_material[m]); });
    add_row(tables.work, [&](std::size_t m) { return cost_text(by_material[m]); });
    const std::string name = fmt::format("stability-{:02}", ++number);
    draw_case(by_material, setting.out / (name + ".png"));
    section.pictures.push_back({name, hard.name});
  }
  section.pictures.front().note =
      "Each row: the start, and the last frame with each material, in the order of the tables and each enlarged to its "
      "panel. Surfaces seen from inside are red.";
  section.text = fmt::format("{} runs: {} keep their rule, {} break it; {} of those without a warning.", counts.runs,
                             counts.passed, counts.runs - counts.passed, counts.silent);
  MeetingTables meeting = meeting_tables(setting);
  section.text += fmt::format(
      " Of bodies that meet, {} runs: {} keep their rules, {} break one; {} of those without a warning.",
      meeting.counts.runs, meeting.counts.runs - meeting.counts.failed, meeting.counts.failed, meeting.counts.silent);
  section.tables = {std::move(tables.ends),   std::move(meeting.ends), returns.table(),
                    std::move(tables.errors), std::move(tables.work),  std::move(meeting.figures)};
  return section;
}

}  // namespace supple
