#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/bench/sections.h"
#include "baselines/make_rule.h"
#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"

namespace supple {

std::vector<SubjectChoice> all_subjects() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / "scenes"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<SubjectChoice> choices;
  for (const auto& file : files) {
    if (file.extension() != ".toml") continue;
    for (const BodyDef& body : load_scene(file, assets_folder(), {}).bodies)
      choices.push_back({file.stem().string(), body.name});
  }
  return choices;
}

namespace {

struct MethodTimes {
  SolverEntry entry;
  std::vector<std::vector<double>> times = {};  // by goal, by state; infinity: not reached [ms]
  int failed = 0;

  // Adds a state, for which no goal is reached so far.
  void add_state() {
    for (std::vector<double>& by_state : times) by_state.push_back(std::numeric_limits<double>::infinity());
  }
};

std::vector<MethodTimes> all_methods() {
  return {{{"ours", Method::quasi_newton, 200}},
          {{"ours, two levels", Method::quasi_newton, 200, 5, {}, {StartMatrix::system, true}}},
          {{"ours, tangent", Method::quasi_newton, 200, 5, {}, {StartMatrix::tangent}}},
          {{"Projective Dynamics", Method::projective_dynamics, 300}},
          {{"Chebyshev", Method::chebyshev, 300}},
          {{"ADMM", Method::admm, 300}},
          {{"vertex block descent", Method::vertex_block_descent, 300}},
          {{"Newton", Method::newton, 15}},
          {{"Newton, on demand", Method::newton_on_demand, 20}},
          {{"Newton, shifted", Method::newton_shifted, 20}},
          {{"Newton, 5 CG", Method::newton_cg(5), 60}},
          {{"Newton, 15 CG", Method::newton_cg(15), 40}},
          {{"Gast et al.", Method::gast, 20}},
          {{"ours, 15 CG", Method::quasi_newton_cg(15), 100}},
          {{"identity", Method::lbfgs_from(StartMatrix::identity), 200}},
          {{"rest pose", Method::lbfgs_from(StartMatrix::rest_hessian), 200}},
          {{"rest pose, warped", Method::lbfgs_from(StartMatrix::warped_rest_hessian), 200}},
          {{"frame's start", Method::lbfgs_from(StartMatrix::frame_hessian), 40}},
          {{"15 CG, ichol of ours", Method::frame_cg(15, Preconditioner::system), 40}}};
}

// Describes when a state counts as solved: to a tolerance of equation 12, or of the error of motion.
struct Goal {
  double tolerance;
  bool of_motion = false;
};

constexpr Goal goals[] = {{1e-1}, {1e-2}, {1e-3}, {1e-4}, {1e-6}, {1e-1, true}, {1e-2, true}, {1e-3, true}};

std::string text_of(const Goal& goal) {
  return fmt::format("{:g}{}", goal.tolerance, goal.of_motion ? " in motion" : "");
}

// Returns the times at which an outcome reaches the goals; infinity for a goal that it does not reach [ms].
std::vector<double> times_of(SolverComparison& comparison, const BenchState& state, const Outcome& outcome,
                             const Minimum& lowest) {
  const std::vector<double> motion = comparison.motion_errors(state, outcome, lowest.x);
  std::vector<double> times;
  for (const Goal& goal : goals)
    times.push_back(goal.of_motion ? time_to(outcome, motion, goal.tolerance)
                                   : time_to(outcome, lowest.below_y, goal.tolerance));
  return times;
}

ReportPlot profile_plot(const std::vector<MethodTimes>& list, std::size_t t) {
  const std::size_t states = list.front().times.front().size();
  ReportPlot plot{fmt::format("profile-{}", t), fmt::format("Share of states solved to {}", text_of(goals[t]))};
  plot.x_label = "time over the fastest method's";
  plot.y_label = "share of states";
  plot.log_x = true;
  plot.log_y = false;
  plot.style = ReportPlot::Style::steps;
  plot.x_min = 1;
  plot.x_max = 100;
  plot.y_min = 0;
  plot.y_max = 1;
  for (const MethodTimes& method : list) {
    std::vector<double> ratios;
    for (std::size_t s = 0; s < states; ++s) {
      double fastest = std::numeric_limits<double>::infinity();
      for (const MethodTimes& other : list) fastest = std::min(fastest, other.times[t][s]);
      if (std::isfinite(method.times[t][s])) ratios.push_back(method.times[t][s] / fastest);
    }
    std::sort(ratios.begin(), ratios.end());
    PlotSeries curve{method.entry.label};
    curve.thick = method.entry.label == "ours";
    curve.x.push_back(1);
    curve.y.push_back(0);
    for (std::size_t k = 0; k < ratios.size(); ++k) {
      curve.x.push_back(ratios[k]);
      curve.y.push_back(static_cast<double>(k + 1) / static_cast<double>(states));
    }
    curve.x.push_back(100);
    curve.y.push_back(
        static_cast<double>(std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 100; })) /
        static_cast<double>(states));
    plot.series.push_back(std::move(curve));
  }
  return plot;
}

ReportTable share_solved_table(const std::vector<MethodTimes>& list, const std::string& name,
                               const std::string& title) {
  const std::size_t states = list.front().times.front().size();
  ReportTable table{name, title};
  table.note =
      "Solved within the iterations that the method was given: that many of all states, and in how many of them "
      "no other method was faster. ADMM has no local step for cloth of a fabric, whose states it does not solve.";
  table.columns = {"method", "iterations at most"};
  for (const Goal& goal : goals) {
    table.columns.push_back("solved to " + text_of(goal));
    table.columns.push_back("fastest to " + text_of(goal));
  }
  table.columns.emplace_back("states");
  table.columns.emplace_back("runs that failed");
  for (const MethodTimes& method : list) {
    std::vector<std::string> row = {method.entry.label, std::to_string(method.entry.iterations)};
    for (std::size_t t = 0; t < std::size(goals); ++t) {
      int solved = 0, first = 0;
      for (std::size_t s = 0; s < states; ++s) {
        const double own = method.times[t][s];
        if (!std::isfinite(own)) continue;
        ++solved;
        first += std::none_of(list.begin(), list.end(), [&](const MethodTimes& o) { return o.times[t][s] < own; });
      }
      row.push_back(std::to_string(solved));
      row.push_back(std::to_string(first));
    }
    row.push_back(std::to_string(states));
    row.push_back(std::to_string(method.failed));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

ReportSection bench_profiles(const BenchSetting& setting) {
  // Bodies that can touch something form a group of their own, because the methods treat contacts in their directions
  // in different ways.
  std::vector<MethodTimes> groups[2] = {all_methods(), all_methods()};
  for (auto& group : groups) {
    for (MethodTimes& method : group) method.times.resize(std::size(goals));
  }
  ReportTable raw{"profiles-states", "Every state: time to each tolerance"};
  raw.columns = {"scene", "body", "frame", "state hash", "method"};
  for (const Goal& goal : goals) raw.columns.push_back(fmt::format("time to {} [ms]", text_of(goal)));
  raw.columns.insert(raw.columns.end(), {"last error", "minimum confirmed"});
  int bodies = 0, unsure = 0, states_in_all = 0;
  for (const SubjectChoice& choice : all_subjects()) {
    Subject subject(choice);
    if (subject.model().vertices > most_vertices) continue;
    ++bodies;
    std::vector<MethodTimes>& list = groups[subject.world.colliders().colliders.empty() ? 0 : 1];
    say_doing(setting, fmt::format("{}, {} ({})", choice.scene, choice.body, subject.size_text()));
    SolverComparison comparison(subject, *setting.threads);
    std::vector<BenchState> states = states_of(subject, {6, 12, 18, 30, 42, 54, 66}, setting);
    std::vector<SolverEntry> entries;
    std::vector<MethodTimes*> suited;  // in the order of the entries
    for (MethodTimes& method : list) {
      if (why_unsuited(method.entry.method, subject.model())) continue;
      entries.push_back(method.entry);
      suited.push_back(&method);
    }
    train_chebyshev(comparison, states[1], entries);
    states.erase(states.begin() + 1);  // the state for training
    for (const BenchState& state : states) {
      const std::vector<Outcome> outcomes = comparison.run(state, entries, 1, 200);
      const Minimum lowest = comparison.reference(state, outcomes);
      const double scale = subject.model().total_mass * std::pow(subject.model().size / subject.model().time_step, 2);
      if (!(lowest.below_y > 1e-12 * scale)) continue;  // at rest: nothing to solve
      ++states_in_all;
      unsure += !lowest.positive_definite;
      for (MethodTimes& method : list) method.add_state();
      for (std::size_t m = 0; m < suited.size(); ++m) {
        std::vector<std::string> row = {choice.scene, choice.body, std::to_string(state.frame),
                                        fmt::format("{:016x}", state.hash), outcomes[m].label};
        const std::vector<double> times = times_of(comparison, state, outcomes[m], lowest);
        for (std::size_t t = 0; t < std::size(goals); ++t) {
          suited[m]->times[t].back() = times[t];
          row.push_back(number_text(times[t]));
        }
        suited[m]->failed += outcomes[m].failed;
        row.push_back(number_text(last_error(outcomes[m], lowest.below_y)));
        row.emplace_back(lowest.positive_definite ? "yes" : "no");
        raw.rows.push_back(std::move(row));
      }
    }
  }
  ReportSection section{"profiles", "All methods on all states"};
  section.text = fmt::format(
      "{} states of {} bodies of up to {} vertices, from all scenes that ship. Performance profiles, of scenes without "
      "colliders: for each method the share of states that it solves within so many times the fastest method's time. "
      "The Hessian at the reference, nothing projected, has no Cholesky factor in {} of all states.",
      states_in_all, bodies, most_vertices, unsure);
  section.tables.push_back(
      share_solved_table(groups[0], "profiles", "Scenes without colliders: states solved, and how often fastest"));
  section.tables.push_back(share_solved_table(groups[1], "profiles-colliders", "The same, scenes with colliders"));
  section.tables.back().note +=
      " Ours, Projective Dynamics and Chebyshev's method correct directions for contacts, Newton's kin have those that "
      "touch in the Hessian, the others learn of them from L-BFGS pairs alone: these rows compare that, too.";
  for (std::size_t t = 0; t < std::size(goals); ++t) section.plots.push_back(profile_plot(groups[0], t));
  write_csv(raw, setting.out);  // the table is too long for the page
  section.text += " The times of every state are in profiles-states.csv.";
  return section;
}

ReportSection bench_scenes(const BenchSetting& setting) {
  ReportSection section{"scenes", "Error against milliseconds, scene by scene"};
  section.text = "One state a scene, our meshes; thick is ours.";
  const std::vector<std::pair<SubjectChoice, int>> picks = {
      {{"thin-sheet", "sheet"}, 30},   {{"spline-spheres", "a"}, 30}, {{"spline-spheres", "b"}, 30},
      {{"shaking-bar", "bar"}, 40},    {{"blob", "blob"}, 20},        {{"hippo", "hippo"}, 10},
      {{"twisting-bar", "bar"}, 130},  {{"cloth", "lbfgs"}, 30},      {{"bunny-torus", "bunny"}, 72},
      {{"squirrel", "polynomial"}, 35}};
  ReportTable table{"scenes", "Time to an error"};
  table.columns = {"scene", "body", "frame", "vertices", "method"};
  for (const Goal& goal : goals) table.columns.push_back(fmt::format("to {} [ms]", text_of(goal)));
  table.columns.emplace_back("minimum confirmed");
  for (const auto& [choice, frame] : picks) {
    Subject subject(choice);
    SolverComparison comparison(subject, *setting.threads);
    const std::vector<BenchState> states = states_of(subject, {frame - 6, frame}, setting);
    const BenchState& state = states.back();
    std::vector<SolverEntry> entries = {{"ours", Method::quasi_newton, 100},
                                        {"Projective Dynamics", Method::projective_dynamics, 100},
                                        {"Chebyshev", Method::chebyshev, 100},
                                        {"Newton", Method::newton, 12},
                                        {"Newton, 15 CG", Method::newton_cg(15), 40},
                                        {"ADMM", Method::admm, 100},
                                        {"vertex block descent", Method::vertex_block_descent, 100},
                                        {"ours, two levels", Method::quasi_newton, 100},
                                        {"ours, tangent", Method::quasi_newton, 100}};
    entries[entries.size() - 2].start = {StartMatrix::system, true};
    entries[entries.size() - 1].start = {StartMatrix::tangent};
    train_chebyshev(comparison, states.front(), entries);
    const std::vector<Outcome> outcomes = comparison.run(state, entries, 2, 2000);
    const Minimum lowest = comparison.reference(state, outcomes);
    ReportPlot plot{fmt::format("scene-{}-{}", choice.scene, choice.body),
                    fmt::format("{}, {} ({})", choice.scene, choice.body, subject.size_text())};
    plot.x_label = "time [ms]";
    plot.y_label = "error (equation 12)";
    plot.log_x = true;
    plot.y_min = 1e-10;
    plot.y_max = 2;
    for (const Outcome& outcome : outcomes) {
      const std::vector<double> errors = errors_of(outcome, lowest.below_y);
      PlotSeries curve{outcome.label, outcome.ms, errors};
      curve.thick = outcome.label == "ours";
      plot.series.push_back(std::move(curve));
      std::vector<std::string> row = {choice.scene, choice.body, std::to_string(frame),
                                      std::to_string(subject.model().vertices), outcome.label};
      for (const double ms : times_of(comparison, state, outcome, lowest)) row.push_back(number_text(ms));
      row.emplace_back(lowest.positive_definite ? "yes" : "no");
      table.rows.push_back(std::move(row));
    }
    section.plots.push_back(std::move(plot));
  }
  section.tables.push_back(std::move(table));
  return section;
}

ReportSection bench_minima(const BenchSetting& setting) {
  ReportSection section{"minima", "Whether solvers that converge find the same minimum"};
  ReportTable table{"minima", "20 states"};
  table.columns = {"scene",
                   "body",
                   "frame",
                   "method",
                   "iterations",
                   "ends",
                   "furthest vertex [of the size]",
                   "objective above the lowest [of g(y) - g*]",
                   "verdict"};
  const std::vector<SubjectChoice> picks = {{"blob", "blob"},
                                            {"shaking-bar", "bar"},
                                            {"spline-spheres", "a"},
                                            {"spline-spheres", "b"},
                                            {"thin-sheet", "sheet"}};
  const std::vector<SolverEntry> entries = {
      {"ours", Method::quasi_newton, 5000, 20},
      {"Newton", Method::newton, 150},
      {"Newton, on demand", Method::newton_on_demand, 400},
      {"Newton, shifted", Method::newton_shifted, 400},
      {"Newton, 15 CG", Method::newton_cg(15), 2000},
      {"Gast et al.", Method::gast, 400},
      {"frame's start", Method::lbfgs_from(StartMatrix::frame_hessian), 1000, 20}};
  int same = 0, other = 0, unfinished = 0;
  for (const SubjectChoice& choice : picks) {
    Subject subject(choice);
    SolverComparison comparison(subject, *setting.threads);
    for (const BenchState& state : states_of(subject, {15, 30, 45, 60}, setting)) {
      const std::vector<Outcome> outcomes = comparison.run(state, entries, 0);
      const Minimum lowest = comparison.reference(state, outcomes);
      for (const Outcome& outcome : outcomes) {
        const double away = (outcome.x - lowest.x).rowwise().norm().maxCoeff() / subject.model().size;
        const bool equal = !outcome.failed && away < 1e-8;
        // An outcome is at another minimum when a search that starts from it does not reach the lowest one.
        const bool elsewhere =
            !equal && !outcome.failed && comparison.reference(state, {outcome}).below_y < (1 - 1e-9) * lowest.below_y;
        same += equal;
        other += elsewhere;
        unfinished += !equal && !elsewhere;
        table.rows.push_back({choice.scene, choice.body, std::to_string(state.frame), outcome.label,
                              std::to_string(outcome.iterations),
                              std::string(outcome.failed ? "failed" : name_of(outcome.stop_reason)), number_text(away),
                              number_text(last_error(outcome, lowest.below_y)),
                              equal       ? "same"
                              : elsewhere ? "another minimum"
                                          : "stopped early"});
      }
    }
  }
  section.text = fmt::format(
      "Each method ran until round-off or its last iteration. Of {} runs {} ended within 1e-8 of the body's size of "
      "the "
      "reference, {} in another minimum, {} stopped early.",
      same + other + unfinished, same, other, unfinished);
  section.tables.push_back(std::move(table));
  return section;
}

std::string list_text(const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); }

}  // namespace supple
