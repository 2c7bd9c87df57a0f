#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"

namespace supple {
namespace {

// Returns the example of all convergence figures: the twisting bar, on the paper's mesh where that is available.
SubjectChoice twisting_bar(const BenchSetting& setting) {
  const SubjectChoice ours{"twisting-bar", "bar"};
  return with_paper_mesh(setting, ours, "longbar2.mesh").value_or(ours);
}

constexpr int example_frame = 130;

// Returns our method with directions that start otherwise than the paper's, for figures whose other curves are the
// paper's.
SolverEntry started(DirectionStart start) {
  SolverEntry entry{"ours, " + text_of(start), Method::quasi_newton, 100};
  entry.start = start;
  return entry;
}
const DirectionStart two_levels = {StartMatrix::system, true}, tangent = {StartMatrix::tangent};

double at_iteration(const std::vector<double>& errors, int k) {
  if (std::size_t(k) < errors.size()) return errors[k];
  return !errors.empty() && errors.back() < 1e-11 ? errors.back() : std::nan("");  // stopped at round-off, or too early
}

// Holds what solvers achieved on one state: errors of motion by solver and iteration, and g(y) - g* [J].
struct Curves {
  std::vector<Outcome> outcomes;
  std::vector<std::vector<double>> motion_errors = {};
  double whole = 0;

  void compare_with(SolverComparison& comparison, const BenchState& state, const Minimum& lowest) {
    whole = lowest.below_y;
    for (const Outcome& outcome : outcomes) motion_errors.push_back(comparison.motion_errors(state, outcome, lowest.x));
  }
};

// Returns a curve that ends before round-off.
PlotSeries curve_of(const Outcome& outcome, const std::vector<double>& errors, bool by_time) {
  PlotSeries curve{outcome.label};
  for (std::size_t k = 0; k < std::min(errors.size(), outcome.ms.size()); ++k) {
    if (errors[k] < 1e-14) break;
    curve.x.push_back(by_time ? outcome.ms[k] : static_cast<double>(k));
    curve.y.push_back(errors[k]);
  }
  return curve;
}

// Adds the curves of one state, as three plots and a table.
void add_curves(ReportSection& section, const std::string& name, const Curves& curves, const std::string& ours) {
  ReportPlot by_iteration{name + "-iterations", "Error by iteration"}, by_time{name + "-time", "Error by time"},
      motion_by_time{name + "-motion", "Error of motion by time"};
  by_iteration.x_label = "iteration";
  for (ReportPlot* plot : {&by_time, &motion_by_time}) {
    plot->x_label = "time [ms]";
    plot->log_x = true;
  }
  ReportTable table{name, "The same in numbers"};
  table.columns = {"method",
                   "error after 1",
                   "after 5",
                   "after 10",
                   "after 20",
                   "after 50",
                   "10 iterations [ms]",
                   "to 1e-2 [ms]",
                   "to 1e-4 [ms]",
                   "to 1e-6 [ms]",
                   "motion error after 3",
                   "motion error after 5",
                   "motion error after 10",
                   "to 1e-2 in motion [ms]",
                   "to 1e-3 in motion [ms]",
                   "trials",
                   "iterations"};
  double longest = 0;
  for (std::size_t i = 0; i < curves.outcomes.size(); ++i) {
    const Outcome& outcome = curves.outcomes[i];
    const std::vector<double> errors = errors_of(outcome, curves.whole);
    const std::vector<double>& motion = curves.motion_errors[i];
    by_iteration.series.push_back(curve_of(outcome, errors, false));
    by_time.series.push_back(curve_of(outcome, errors, true));
    motion_by_time.series.push_back(curve_of(outcome, motion, true));
    if (outcome.label == ours) {
      for (ReportPlot* plot : {&by_iteration, &by_time, &motion_by_time}) plot->series.back().thick = true;
      if (!by_time.series.back().x.empty()) longest = by_time.series.back().x.back();
    }
    const auto ms_at = [&](std::size_t k) { return outcome.ms.size() > k ? outcome.ms[k] : std::nan(""); };
    table.rows.push_back({outcome.label, number_text(at_iteration(errors, 1)), number_text(at_iteration(errors, 5)),
                          number_text(at_iteration(errors, 10)), number_text(at_iteration(errors, 20)),
                          number_text(at_iteration(errors, 50)), number_text(ms_at(10)),
                          number_text(time_to(outcome, curves.whole, 1e-2)),
                          number_text(time_to(outcome, curves.whole, 1e-4)),
                          number_text(time_to(outcome, curves.whole, 1e-6)), number_text(at_iteration(motion, 3)),
                          number_text(at_iteration(motion, 5)), number_text(at_iteration(motion, 10)),
                          number_text(time_to(outcome, motion, 1e-2)), number_text(time_to(outcome, motion, 1e-3)),
                          std::to_string(outcome.trials), std::to_string(outcome.iterations)});
  }
  for (ReportPlot* plot : {&by_iteration, &by_time}) {
    plot->y_label = "error (equation 12)";
    plot->y_min = 1e-12;
    plot->y_max = 2;
  }
  by_iteration.x_min = 0;
  by_iteration.x_max = 60;
  motion_by_time.y_label = "error of motion";
  motion_by_time.y_min = 1e-6;
  motion_by_time.y_max = 2;
  for (ReportPlot* plot : {&by_time, &motion_by_time}) {
    plot->x_min = 0.2;
    plot->x_max = std::max(20 * longest, 1000.0);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(by_iteration));
  section.plots.push_back(std::move(by_time));
  section.plots.push_back(std::move(motion_by_time));
}

ReportSection compare(const BenchSetting& setting, const std::string& name, const std::string& heading,
                      std::vector<SolverEntry> entries, const std::string& ours, const std::string& text) {
  Subject subject(twisting_bar(setting));
  SolverComparison comparison(subject, *setting.threads);
  const std::vector<BenchState> states = states_of(subject, {60, example_frame}, setting);
  train_chebyshev(comparison, states[0], entries);
  Curves curves{comparison.run(states[1], entries, 5)};
  const Minimum lowest = comparison.reference(states[1], curves.outcomes);
  curves.compare_with(comparison, states[1], lowest);
  ReportSection section{name, heading};
  section.text =
      fmt::format("Twisting bar, Neo-Hookean, frame {} ({}). {}{}", example_frame, subject.size_text(), text,
                  lowest.positive_definite ? " The reference is a minimum: its Hessian has a Cholesky factor."
                                           : " The Hessian at the reference has no Cholesky factor.");
  add_curves(section, name, curves, ours);
  return section;
}

}  // namespace

ReportSection bench_figure7(const BenchSetting& setting) {
  return compare(setting, "figure7", "Figure 7: L-BFGS, Chebyshev, Newton",
                 {{"Projective Dynamics (m = 0)", Method::projective_dynamics, 100},
                  {"Chebyshev", Method::chebyshev, 100},
                  {"ours, m = 2", Method::quasi_newton, 100, 2},
                  {"ours, m = 5", Method::quasi_newton, 100, 5},
                  started(two_levels),
                  started(tangent),
                  {"Newton", Method::newton, 12}},
                 "ours, m = 5",
                 "The paper's order: by iterations Newton first, then m = 5, m = 2, Chebyshev, Projective Dynamics; by "
                 "time m = 5 first. Chebyshev's radius was trained on another frame of the same motion.");
}

ReportSection bench_figure8(const BenchSetting& setting) {
  return compare(
      setting, "figure8", "Figure 8: initial Hessians",
      {{"ours", Method::quasi_newton, 100},
       started(two_levels),
       started(tangent),
       {"scaled identity", Method::lbfgs_from(StartMatrix::identity), 100},
       {"rest pose", Method::lbfgs_from(StartMatrix::rest_hessian), 100},
       {"rest pose, warped", Method::lbfgs_from(StartMatrix::warped_rest_hessian), 100},
       {"frame's start", Method::lbfgs_from(StartMatrix::frame_hessian), 40},
       {"Newton", Method::newton, 12}},
      "ours",
      "L-BFGS with m = 5 from each. The paper's order by time: ours, then the warped rest pose, the rest pose "
      "and the identity; the Hessian of the frame's start is best by iterations and pays for its "
      "factorisation.");
}

ReportSection bench_rivals(const BenchSetting& setting) {
  const Method plain_blocks = {.matrix = StartMatrix::vertex_blocks, .acceleration = Acceleration::none};
  return compare(setting, "rivals", "Methods of other papers",
                 {{"ours", Method::quasi_newton, 100},
                  started(two_levels),
                  started(tangent),
                  {"Projective Dynamics", Method::projective_dynamics, 100},
                  {"ADMM", Method::admm, 200},
                  {"vertex block descent", Method::vertex_block_descent, 300},
                  {"the same, not accelerated", plain_blocks, 300},
                  {"Newton", Method::newton, 12},
                  {"Newton, on demand", Method::newton_on_demand, 12}},
                 "ours",
                 "ADMM is that of Overby et al. 2017 with our factor, vertex block descent that of Chen et al. 2024 "
                 "with a radius trained on another frame of the same motion; Newton's method on demand is that of "
                 "Longva et al. 2023.");
}

ReportSection bench_figure13(const BenchSetting& setting) {
  std::vector<SolverEntry> windows;
  for (const int m : {0, 1, 2, 3, 5, 8, 10, 20, 50, 100})
    windows.push_back({fmt::format("m = {}", m), Method::quasi_newton, 100, m});
  windows.push_back(started(two_levels));
  windows.push_back(started(tangent));
  return compare(setting, "figure13", "Figure 13: window of L-BFGS", windows, "m = 5",
                 "In the paper m = 5 is best and m = 100 slightly worse.");
}

ReportSection bench_figure16(const BenchSetting& setting) {
  return compare(
      setting, "figure16", "Figure 16: direct solves and conjugate gradients",
      {{"ours", Method::quasi_newton, 100},
       started(two_levels),
       started(tangent),
       {"ours, 5 CG", Method::quasi_newton_cg(5), 100},
       {"ours, 15 CG", Method::quasi_newton_cg(15), 100},
       {"Newton", Method::newton, 12},
       {"Newton, 5 CG", Method::newton_cg(5), 100},
       {"Newton, 15 CG", Method::newton_cg(15), 100},
       {"Gast et al.", Method::gast, 40}},
      "ours",
      "Preconditioners are Jacobi. In the paper conjugate gradients are slower than the direct solve in both "
      "families, and Gast's method leads Newton's with conjugate gradients at first.");
}

ReportSection bench_figure17(const BenchSetting& setting) {
  return compare(setting, "figure17", "Figure 17: preconditioners",
                 {{"ours", Method::quasi_newton, 100},
                  {"frame's start, direct", Method::lbfgs_from(StartMatrix::frame_hessian), 40},
                  {"5 CG, ichol of rest pose", Method::frame_cg(5, Preconditioner::rest), 60},
                  {"15 CG, ichol of rest pose", Method::frame_cg(15, Preconditioner::rest), 60},
                  {"5 CG, ichol of ours", Method::frame_cg(5, Preconditioner::system), 60},
                  {"15 CG, ichol of ours", Method::frame_cg(15, Preconditioner::system), 60}},
                 "ours",
                 "L-BFGS from the Hessian of the frame's start, solved with preconditioned conjugate gradients. In the "
                 "paper our matrix is the better preconditioner of the two.");
}

namespace {

constexpr double flat_enough = 0.9;  // gamma_2, the largest share of the slope that Wolfe's second condition allows

// Returns the cells that tell in how many of the iterations the full step was taken, decreased g enough, and was flat
// enough, too [%].
std::vector<std::string> full_steps(const std::vector<IterationRecord>& records) {
  int taken = 0, decreases = 0, both = 0;
  for (const IterationRecord& record : records) {
    if (record.alpha == 0) continue;  // a new start
    taken += record.alpha == 1;
    decreases += record.full.decreases;
    both += record.full.decreases && std::abs(record.full.slope_ratio) <= flat_enough;
  }
  const double share = 100.0 / std::max<double>(1, static_cast<double>(records.size()));
  return {number_text(share * taken), number_text(share * decreases), number_text(share * both)};
}

PlotSeries step_lengths(const Outcome& outcome) {
  PlotSeries points{outcome.label};
  for (std::size_t k = 0; k < outcome.records.size(); ++k) {
    if (outcome.records[k].alpha == 0) continue;
    points.x.push_back(static_cast<double>(k + 1));
    points.y.push_back(outcome.records[k].alpha);
  }
  return points;
}

}  // namespace

// Counts how often the full step satisfies Armijo's and Wolfe's conditions. Where it does, a search by Wolfe's
// conditions would make the same iterate as backtracking does, because it tries the full step first.
ReportSection bench_figure14(const BenchSetting& setting) {
  Subject subject(twisting_bar(setting));
  SolverComparison comparison(subject, *setting.threads);
  const std::vector<BenchState> states = states_of(subject, {30, 60, 120, example_frame, 150}, setting);
  ReportSection section{"figure14", "Figure 14: step lengths"};
  ReportPlot plot{"figure14-steps", fmt::format("Step lengths, frame {}", example_frame)};
  plot.x_label = "iteration";
  plot.y_label = "alpha";
  plot.log_y = false;
  plot.style = ReportPlot::Style::points;
  ReportTable table{"figure14", "How often the full step does"};
  table.columns = {"frame",
                   "iterations",
                   "alpha = 1 taken [%]",
                   "full step decreases enough [%]",
                   "full step is flat enough too [%]",
                   "error after 10",
                   "10 iterations [ms]",
                   "trials"};
  for (const BenchState& state : states) {
    const Outcome outcome = comparison.run(state, {{"Armijo", Method::quasi_newton, 30}}, 3).front();
    const Minimum lowest = comparison.reference(state, {outcome});
    const std::vector<double> errors = errors_of(outcome, lowest.below_y);
    std::vector<std::string> row = {std::to_string(state.frame), std::to_string(outcome.iterations)};
    for (std::string& cell : full_steps(outcome.records)) row.push_back(std::move(cell));
    row.push_back(number_text(at_iteration(errors, 10)));
    row.push_back(number_text(outcome.ms.size() > 10 ? outcome.ms[10] : std::nan("")));
    row.push_back(std::to_string(outcome.trials));
    table.rows.push_back(std::move(row));
    if (state.frame == example_frame) plot.series.push_back(step_lengths(outcome));
  }
  section.text = fmt::format(
      "Twisting bar ({}). Armijo's backtracking, and how often the full step satisfies both of the strong Wolfe "
      "conditions with gamma_2 = {}: there a search by them would take it, too. In the paper the full step nearly "
      "always satisfies both.",
      subject.size_text(), flat_enough);
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

ReportSection bench_figure15(const BenchSetting& setting) {
  ReportSection section{"figure15", "Figure 15: the interval of equation 11"};
  Curves curves;
  std::optional<BenchState> state;
  std::string sizes, stiffnesses;
  for (const double half : {0.5, 0.4, 0.3, 0.2, 0.1, 0.01}) {
    SubjectChoice choice = twisting_bar(setting);
    choice.settings.push_back(fmt::format("solver.fit_from={:g}", 1 - half));
    choice.settings.push_back(fmt::format("solver.fit_to={:g}", 1 + half));
    Subject subject(choice);
    SolverComparison comparison(subject, *setting.threads);
    if (!state) state = states_of(subject, {example_frame}, setting).front();  // all methods start from the same state
    const std::string label = fmt::format("[{:g}, {:g}]", 1 - half, 1 + half);
    curves.outcomes.push_back(comparison.run(*state, {{label, Method::quasi_newton, 100}}, 5).front());
    const Outcome& outcome = curves.outcomes.back();
    const Minimum lowest = comparison.reference(*state, {outcome});
    curves.whole = std::max(curves.whole, lowest.below_y);
    curves.motion_errors.push_back(comparison.motion_errors(*state, outcome, lowest.x));
    stiffnesses +=
        fmt::format("{}{}: k = {:.4g}", stiffnesses.empty() ? "" : "; ", label, subject.model().stiffness[0].k);
    sizes = subject.size_text();
  }
  section.text =
      fmt::format("Twisting bar, frame {} ({}); stiffness by interval: {}. In the paper the curves nearly coincide.",
                  example_frame, sizes, stiffnesses);
  add_curves(section, "figure15", curves, "[0.5, 1.5]");
  return section;
}

}  // namespace supple
