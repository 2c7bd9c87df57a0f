#include "app/bench/stability_matrix.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "film/places.h"
#include "output/profile.h"
#include "scene/scene_reader.h"
#include "sim/model/measures.h"
#include "sim/solver/energies.h"

namespace supple {
namespace {

constexpr double much_energy = 0.2;  // from nothing, over what was exchanged: where a run warns
// The strain limits have no force up to 1.05, and the polynomial hardly any.
constexpr double rest_stretch = 1.06;

SceneDef scene_of(const std::string& text) {
  Config config = Config::parse(text, "hard case", assets_folder());
  SceneDef scene = read_scene(config);
  config.finish();
  return scene;
}

// Names the rule that an outcome breaks; empty: none.
std::string broken_rule(const StabilityOutcome& outcome, StableEnd end) {
  if (!outcome.finite) return "not finite";
  if (outcome.from_nothing > much_energy)
    return fmt::format("{:.0f} % energy from nothing", 100 * outcome.from_nothing);
  if (end != StableEnd::bounded && outcome.inverted > 0) return fmt::format("{} inverted", outcome.inverted);
  if (end != StableEnd::bounded && outcome.collapsed > 0) return fmt::format("{} without volume", outcome.collapsed);
  if (end == StableEnd::recovered && outcome.stretch > rest_stretch)
    return fmt::format("stretch {:.2f}", outcome.stretch);
  return "";
}

}  // namespace

std::vector<NamedMaterial> stability_materials() {
  std::vector<NamedMaterial> list;
  for (const char* name :
       {"corotated", "st-venant-kirchhoff", "neo-hookean", "mooney-rivlin", "fixed-corotated", "stable-neo-hookean"})
    list.push_back({name, fmt::format("{{ model = \"{}\", young = 3e4, poisson = 0.35 }}", name)});
  list.push_back({"as-rigid-as-possible", "{ model = \"as-rigid-as-possible\", mu = 1.5e4 }"});
  list.push_back({"polynomial", "{ model = \"polynomial\", mu = 1e5 }"});
  for (const char* preset : {"A", "B"})
    list.push_back({fmt::format("spline {}", preset),
                    fmt::format("{{ model = \"spline\", preset = \"{}\", young = 3e4, poisson = 0.35 }}", preset)});
  list.push_back({"strain-limiting", "{ model = \"strain-limiting\", mu_1 = 1.5e4, low_1 = 0.95, high_1 = 1.05 }"});
  return list;
}

namespace {

// Plays the scene of a case that is drawn by one seed.
StabilityOutcome run_scene(const std::string& text, StableEnd end, Threads& threads) {
  const SceneDef scene = scene_of(text);
  Body body = std::move(assemble(scene).front());
  Model model = build_model(body.description);
  const CollisionSet set = collision_set(scene);
  DrivenBody driver(scene, body, model, set, scenes_own_solver(), &threads);
  driver.workspace().prepare(model, driver.inputs().solver);
  EnergyBudget budget;
  budget.start(model, scene.gravity, driver.state(), driver.workspace());
  StabilityOutcome outcome;
  Positions before;
  for (int frame = 0; frame < scene.frames && outcome.finite; ++frame) {
    driver.prepare_step(frame, 0);
    budget.before_step(model, driver.inputs(), driver.state(), driver.workspace());
    before = driver.state().x;
    const StepReport& report = driver.step();
    outcome.finite = !report.failed && driver.state().x.allFinite();
    if (!outcome.finite) break;
    budget.after_step(model, driver.inputs(), before, driver.state(), driver.workspace());
    const EnergyBalance& balance = budget.balance();
    if (balance.exchanged > 0)
      outcome.from_nothing = std::max(outcome.from_nothing, balance.from_nothing / balance.exchanged);
    outcome.error_estimate = std::max(outcome.error_estimate, report.error_estimate);
    outcome.trials += double(report.line_search) / scene.frames;
  }
  const Deformation shape = deformation(model, driver.state().x);
  outcome.stretch = shape.stretch;
  outcome.inverted = shape.inverted;
  outcome.collapsed = shape.collapsed;
  outcome.told = !outcome.finite || outcome.from_nothing > much_energy || shape.inverted > 0 || shape.collapsed > 0;
  outcome.failure = broken_rule(outcome, end);
  return outcome;
}

// Describes what the runs of a case ended as, in a cell: the first rule that was broken, or what a run warns of.
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

}  // namespace

std::vector<StabilityOutcome> run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads) {
  const auto filled = [](std::string text, const std::string& word, const std::string& value) {
    if (const std::size_t at = text.find(word); at != std::string::npos) text.replace(at, word.size(), value);
    return text;
  };
  const std::string scene = filled(hard.scene, "MATERIAL", hard.only.empty() ? material.table : hard.only);
  std::vector<StabilityOutcome> outcomes;
  for (int seed = 1; seed <= hard.seeds; ++seed)
    outcomes.push_back(run_scene(filled(scene, "SEED", std::to_string(seed)), hard.end, threads));
  return outcomes;
}

ReportSection bench_stability(const BenchSetting& setting) {
  ReportSection section{"stability", "Hard cases: what every material makes of them"};
  const std::vector<NamedMaterial> materials = stability_materials();
  ReportTable table{"stability", "What each case ends as"};
  table.note =
      "An empty cell: the rule of the case is kept, and nothing is inverted or without volume at the end. In brackets: "
      "the rule is kept, and the run warns. Without brackets: the rule that is broken; the run warns of all of these "
      "but "
      "a remaining stretch. docs/stability.md has the rules.";
  table.columns = {"case", "rule"};
  for (const NamedMaterial& material : materials) table.columns.push_back(material.name);
  ReportTable work{"stability-work", "Evaluations a frame, and the worst error estimate"};
  work.columns = table.columns;
  int runs = 0, passed = 0, silent = 0;
  for (const HardCase& hard : hard_cases(setting.paper_meshes)) {
    say_doing(setting, hard.name);
    const char* rule = hard.end == StableEnd::recovered ? "at rest"
                       : hard.end == StableEnd::whole   ? "whole"
                                                        : "bounded";
    std::vector<std::string> cells = {hard.name, rule}, costs = {hard.name, rule};
    for (std::size_t m = 0; m < materials.size(); ++m) {
      if (!hard.only.empty() && materials[m].name != "neo-hookean") {
        cells.emplace_back("-");
        costs.emplace_back("-");
        continue;
      }
      const std::vector<StabilityOutcome> outcomes = run_case(hard, materials[m], *setting.threads);
      double trials = 0, error = 0;
      for (const StabilityOutcome& outcome : outcomes) {
        ++runs;
        passed += outcome.passed();
        silent += !outcome.passed() && !outcome.told;
        trials += outcome.trials / double(outcomes.size());
        error = std::max(error, outcome.error_estimate);
      }
      cells.push_back(text_of(outcomes));
      costs.push_back(fmt::format("{:.0f}; {:.1e}", trials, error));
    }
    table.rows.push_back(std::move(cells));
    work.rows.push_back(std::move(costs));
  }
  section.text = fmt::format("{} runs: {} keep their rule, {} break it; {} of those without a warning.", runs, passed,
                             runs - passed, silent);
  section.tables = {std::move(table), std::move(work)};
  return section;
}

}  // namespace supple
