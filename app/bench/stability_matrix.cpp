#include "app/bench/stability_matrix.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

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

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return text;
}

std::string cube(std::string_view keys, int cells = 3, double edge = 0.2) {
  return fmt::format(
      "[[body]]\nname = \"cube\"\nbox = {{ extent = [{0:g}, {0:g}, {0:g}], cells = [{1}, {1}, {1}] }}\nmaterial = "
      "MATERIAL\n{2}\n",
      edge, cells, keys);
}

std::string bar(std::string_view keys) {
  return joined(
      {"[[body]]\nname = \"bar\"\nbox = { extent = [0.6, 0.2, 0.2], cells = [9, 3, 3] }\nmaterial = MATERIAL\n", keys,
       "\n"});
}

constexpr std::string_view held_end =
    "[[body.handles]]\nname = \"end\"\nselect = { box = [[0, 0, 0], [0.01, 1, 1]] }\n";
constexpr std::string_view ground = "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";
constexpr std::string_view weightless = "frames = 90\ngravity = [0, 0, 0]\n", two_seconds = "frames = 60\n";

using Cases = std::vector<HardCase>;

void add(Cases& list, const std::string& name, StableEnd end, std::initializer_list<std::string_view> scene,
         const std::string& only = {}) {
  list.push_back({name, joined(scene), end, only});
}

void add_starts(Cases& list) {
  const auto start = [&](const std::string& name, std::string_view keys, StableEnd end) {
    add(list, name, end, {weightless, cube(joined({"start = { ", keys, " }"}))});
  };
  for (int seed = 1; seed <= 3; ++seed)
    add(list, fmt::format("random positions, seed {}", seed), StableEnd::bounded,
        {fmt::format("seed = {}\n", seed), weightless, cube("start = { random = [0.2, 0.2, 0.2] }")});
  start("collapsed to a point", "flatten = \"point\"", StableEnd::bounded);
  start("collapsed to a line", "flatten = \"line\"", StableEnd::bounded);
  start("collapsed to a plane", "flatten = \"plane\"", StableEnd::bounded);
  start("mirrored", "stretch = [-1, 1, 1]", StableEnd::bounded);
  start("stretched 3 times", "stretch = [3, 1, 1]", StableEnd::recovered);
  start("stretched 10 times", "stretch = [10, 10, 10]", StableEnd::bounded);
  start("squashed to 1 %", "stretch = [1, 0.01, 1]", StableEnd::bounded);
  for (const double turns : {0.5, 2.0, 8.0})
    add(list, fmt::format("twisted {:g} turns", turns), turns < 1 ? StableEnd::recovered : StableEnd::bounded,
        {weightless, bar(fmt::format("start = {{ twist_deg = {:g} }}", 360 * turns))});
}

void add_loads(Cases& list) {
  add(list, "hanging from its end", StableEnd::whole, {two_seconds, bar(held_end)});
  add(list, "gravity x 100", StableEnd::bounded, {two_seconds, "gravity = [0, -981, 0]\n", bar(held_end)});
  add(list, "shaken by its end", StableEnd::whole,
      {two_seconds, bar(held_end),
       "keys = [{ t = 0 }, { t = 0.3, move = [0, 0.6, 0] }, { t = 0.6 }, { t = 0.9, move = [0, 0.6, 0] }, { t = 1.2 "
       "}]"});
  add(list, "light as air", StableEnd::whole, {two_seconds, bar(joined({"density = 1\n", held_end}))});
  add(list, "overloaded", StableEnd::bounded, {two_seconds, bar(joined({"density = 2e4\n", held_end}))});
  for (const double rate : {1000.0, 30.0, 10.0, 2.0})
    add(list, fmt::format("steps of 1/{:g} s", rate), rate >= 30 ? StableEnd::whole : StableEnd::bounded,
        {fmt::format("frames = {}\nfps = {:g}\n", std::clamp(int(rate), 20, 100), rate), bar(held_end)});
  for (const double poisson : {0.45, 0.49, 0.495})
    add(list, fmt::format("Poisson's ratio {:g}", poisson), StableEnd::whole, {two_seconds, bar(held_end)},
        fmt::format("{{ model = \"neo-hookean\", young = 3e4, poisson = {:g} }}", poisson));
  for (const int iterations : {1, 2, 3})
    add(list, fmt::format("{} iteration{}", iterations, iterations == 1 ? "" : "s"), StableEnd::bounded,
        {two_seconds, fmt::format("[solver]\niterations = {}\n", iterations), bar(held_end)});
  for (const int history : {0, 1, 100})
    add(list, fmt::format("window m = {}", history), StableEnd::whole,
        {two_seconds, fmt::format("[solver]\nhistory = {}\n", history), bar(held_end)});
}

void add_motions(Cases& list) {
  const auto falls = [&](const std::string& name, std::string_view keys, StableEnd end) {
    add(list, name, end, {two_seconds, cube(joined({"position = [0, 0.02, 0]\n", keys})), ground});
  };
  falls("dropped", "velocity = [0, -1, 0]", StableEnd::whole);
  falls("impact of one size a step", "velocity = [0, -6, 0]", StableEnd::bounded);
  falls("impact of three sizes a step", "velocity = [0, -18, 0]", StableEnd::bounded);
  add(list, "free fall", StableEnd::recovered, {two_seconds, cube("")});
  add(list, "1e4 sizes from the origin", StableEnd::recovered, {two_seconds, cube("position = [2000, 0, 0]")});
  for (const double edge : {1e-4, 1e-2, 1e2, 1e4})
    add(list, fmt::format("a cube of {:g} m", edge), StableEnd::bounded,
        {weightless, cube("start = { stretch = [1.5, 1, 1] }", 3, edge)});
  add(list, "one cell", StableEnd::recovered, {weightless, cube("start = { stretch = [2, 1, 1] }", 1)});
  add(list, "elements 1:100", StableEnd::bounded,
      {two_seconds,
       "[[body]]\nname = \"sheet\"\nbox = { extent = [1, 0.01, 1], cells = [4, 4, 4] }\nmaterial = MATERIAL\n",
       held_end});
}

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

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> list;
  add_starts(list);
  add_loads(list);
  add_motions(list);
  return list;
}

StabilityOutcome run_case(const HardCase& hard, const NamedMaterial& material, Threads& threads) {
  std::string text = hard.scene;
  const std::string word = "MATERIAL";  // stands in every case's scene for the material's table
  text.replace(text.find(word), word.size(), hard.only.empty() ? material.table : hard.only);
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
  outcome.failure = broken_rule(outcome, hard.end);
  return outcome;
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
  for (const HardCase& hard : hard_cases()) {
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
      const StabilityOutcome outcome = run_case(hard, materials[m], *setting.threads);
      ++runs;
      passed += outcome.passed();
      silent += !outcome.passed() && !outcome.told;
      const std::string remark = outcome.inverted > 0    ? fmt::format("({} inverted)", outcome.inverted)
                                 : outcome.collapsed > 0 ? fmt::format("({} without volume)", outcome.collapsed)
                                                         : "";
      cells.push_back(outcome.passed() ? remark : outcome.failure);
      costs.push_back(fmt::format("{:.0f}; {:.1e}", outcome.trials, outcome.error_estimate));
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
