#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/bench/sections.h"
#include "film/plan/shipped_files.h"

namespace supple {
namespace {

constexpr int sweep_frame = 60;

// Adds one point of a sweep: the times that our method and Newton's take to reach an error.
void add_point(ReportTable& table, ReportPlot& plot, const std::string& sweep, double value,
               const SubjectChoice& choice, const BenchSetting& setting) {
  Subject subject(choice);
  say_doing(setting, fmt::format("{} {:g}", sweep, value));
  SolverComparison comparison(subject, *setting.threads);
  const BenchState state = states_of(subject, {sweep_frame}, setting).front();
  const std::vector<Outcome> outcomes =
      comparison.run(state, {{"ours", Method::quasi_newton, 300}, {"Newton", Method::newton, 15}}, 2, 3000);
  const Minimum lowest = comparison.reference(state, outcomes);
  const std::vector<double> ours = errors_of(outcomes[0], lowest.below_y);
  const std::vector<double> newton = errors_of(outcomes[1], lowest.below_y);
  std::vector<std::string> row = {sweep, number_text(value), std::to_string(subject.model().vertices),
                                  number_text(ours.size() > 10 ? ours[10] : last_error(outcomes[0], lowest.below_y)),
                                  number_text(newton.size() > 1 ? newton[1] : std::nan(""))};
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    for (const Outcome& outcome : outcomes) row.push_back(number_text(time_to(outcome, lowest.below_y, tolerance)));
  }
  table.rows.push_back(std::move(row));
  int series = 0;
  for (const double tolerance : {1e-2, 1e-4}) {
    for (const Outcome& outcome : outcomes) {
      if (plot.series.size() <= std::size_t(series)) {
        plot.series.push_back({fmt::format("{}, to {:g}", outcome.label, tolerance)});
        plot.series.back().thick = series == 0;
        plot.series.back().dashed = tolerance < 1e-3;
      }
      plot.series[series].x.push_back(value);
      plot.series[series].y.push_back(time_to(outcome, lowest.below_y, tolerance));
      ++series;
    }
  }
}

ReportPlot sweep_plot(const std::string& name, const std::string& title, const std::string& label, bool log_x) {
  ReportPlot plot{name, title};
  plot.x_label = label;
  plot.y_label = "time [ms]";
  plot.log_x = log_x;
  return plot;
}

double rms(const Positions& a, const Positions& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.rows()));
}

struct Played {
  Positions x;  // positions after the last frame; NaN where a step failed
  double ms_a_frame = 0;
};

Played play(Subject& subject, Method method, int iterations, int frames, Threads& threads, DirectionStart start = {}) {
  World world = subject.new_world(solver_instead(method, iterations, start), threads);
  const MovingBody& body = world.body(0);
  Played played;
  for (int frame = 0; frame < frames; ++frame) {
    const bool made =
        world.play(frame, {{}, [&](std::size_t, int) { played.ms_a_frame += body.report().step_ms / frames; }});
    if (!made) {
      played.x.setConstant(subject.model().vertices, 3, std::nan(""));
      return played;
    }
  }
  played.x = body.state().x;
  return played;
}

}  // namespace

ReportSection bench_sweeps(const BenchSetting& setting) {
  ReportSection section{"sweeps", "Where Newton overtakes: stiffness, Poisson's ratio, resolution"};
  section.text = fmt::format(
      "Twisting bar, Neo-Hookean, frame {}, our mesh; time to an error for ours and for Newton's method. An infinite "
      "time means not within 300 iterations of ours or 15 of Newton's.",
      sweep_frame);
  ReportTable table{"sweeps", "Time to an error"};
  table.columns = {"sweep",
                   "value",
                   "vertices",
                   "error, ours after 10",
                   "error, Newton after 1",
                   "ours to 1e-2 [ms]",
                   "Newton to 1e-2 [ms]",
                   "ours to 1e-4 [ms]",
                   "Newton to 1e-4 [ms]",
                   "ours to 1e-6 [ms]",
                   "Newton to 1e-6 [ms]"};
  ReportPlot stiffness = sweep_plot("sweep-stiffness", "Stiffness", "mu over the scene's", true);
  for (const double scale : {0.01, 0.1, 1.0, 10.0, 100.0, 1000.0}) {
    const SubjectChoice choice{"twisting-bar",
                               "bar",
                               {fmt::format("body.bar.material.mu={:g}", 80 * scale),
                                fmt::format("body.bar.material.lambda={:g}", 20 * scale)}};
    add_point(table, stiffness, "stiffness", scale, choice, setting);
  }
  ReportPlot poisson =
      sweep_plot("sweep-poisson", "Poisson's ratio at constant Young's modulus", "Poisson's ratio", false);
  for (const double ratio : {0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49}) {
    const SubjectChoice choice{
        "twisting-bar",
        "bar",
        {fmt::format("body.bar.material={{ model = \"neo-hookean\", young = 176, poisson = {:g} }}", ratio)}};
    add_point(table, poisson, "Poisson's ratio", ratio, choice, setting);
  }
  ReportPlot resolution = sweep_plot("sweep-resolution", "Resolution", "cells across", true);
  for (const int across : {3, 5, 7, 10, 14}) {
    const SubjectChoice choice{
        "twisting-bar", "bar", {fmt::format("body.bar.box.cells=[{}, {}, {}]", across * 28 / 10, across, across)}};
    add_point(table, resolution, "cells across", across, choice, setting);
  }
  section.tables.push_back(std::move(table));
  section.plots = {std::move(stiffness), std::move(poisson), std::move(resolution)};
  return section;
}

ReportSection bench_substeps(const BenchSetting& setting) {
  constexpr int frames = 45;
  ReportSection section{"substeps", "The same time spent on substeps instead of iterations"};
  ReportTable table{"substeps", "Distance from the limit of small steps"};
  table.columns = {"scene", "substeps x iterations", "a frame [ms]", "from the limit [of the size]",
                   "from the solved step of the same h [of the size]"};
  for (const SubjectChoice& choice : {SubjectChoice{"shaking-bar", "bar"}, SubjectChoice{"hanging-bar", "bar"}}) {
    SubjectChoice placed = choice;
    if (choice.scene == "hanging-bar") placed.scene = (assets_folder() / "bench" / "hanging-bar.toml").string();
    const auto with_substeps = [&](int substeps) {
      SubjectChoice changed = placed;
      changed.settings.push_back(fmt::format("substeps={}", substeps));
      return changed;
    };
    Subject fine(with_substeps(64));
    const Positions limit = play(fine, Method::quasi_newton, 10, frames, *setting.threads).x;
    for (const auto& [substeps, iterations] :
         std::vector<std::pair<int, int>>{{1, 10}, {2, 5}, {5, 2}, {10, 1}, {1, 2}, {1, 100}}) {
      Subject subject(with_substeps(substeps));
      const Positions solved = play(subject, Method::quasi_newton, 200, frames, *setting.threads).x;
      const Played played = play(subject, Method::quasi_newton, iterations, frames, *setting.threads);
      table.rows.push_back({choice.scene, fmt::format("{} x {}", substeps, iterations), number_text(played.ms_a_frame),
                            number_text(rms(played.x, limit) / subject.model().size),
                            number_text(rms(played.x, solved) / subject.model().size)});
    }
  }
  section.text = fmt::format(
      "Where the body is after {} frames (root mean square over vertices), against 64 substeps of 10 iterations, which "
      "stand for h -> 0, and against backward Euler's own answer with the same h (200 iterations).",
      frames);
  section.tables.push_back(std::move(table));
  return section;
}

namespace {

constexpr int hanging_frames = 60;

// With so many iterations a step is solved to round-off, also on a mesh with slivers, where Newton's method, which
// projects the Hessian, is at an error of 1e-4 after thirty.
constexpr int solving_iterations = 400;

// Holds a hanging bar, and the place where its tip ends when every step is solved.
struct HangingBar {
  Subject subject;
  int tip = 0;  // the vertex furthest along x
  Eigen::RowVector3d solved;

  HangingBar(const std::vector<std::string>& settings, Threads& threads)
      : subject({(assets_folder() / "bench" / "hanging-bar.toml").string(), "bar", settings}) {
    for (int v = 0; v < subject.model().vertices; ++v) {
      if (subject.model().rest(v, 0) > subject.model().rest(tip, 0)) tip = v;
    }
    solved = play(subject, Method::quasi_newton, solving_iterations, hanging_frames, threads).x.row(tip);
  }

  // Appends iterations, time, place of the tip and its distance from the solved one to a row.
  std::vector<std::string> row(std::vector<std::string> cells, int iterations, const Played& played) const {
    const Eigen::RowVector3d at = played.x.row(tip);
    for (std::string cell : {std::to_string(iterations), number_text(played.ms_a_frame), number_text(at.x(), 4),
                             number_text(at.y(), 4), number_text(1000 * (at - solved).norm())})
      cells.push_back(std::move(cell));
    return cells;
  }
};

const std::vector<std::string> tip_columns = {"iterations", "a step [ms]", "tip x [m]", "tip y [m]",
                                              "from the solved one [mm]"};

std::vector<std::string> columns_after(std::vector<std::string> first) {
  first.insert(first.end(), tip_columns.begin(), tip_columns.end());
  return first;
}

const std::vector<DirectionStart> beside_the_papers = {
    {StartMatrix::system, true}, {StartMatrix::tangent}, {StartMatrix::turned_hessian}};

// Compares what directions start from on a slender bar that swings further, on our mesh and on the paper's.
ReportTable slender_table(const BenchSetting& setting) {
  ReportTable table{"hanging-slender", "A slender bar of stable Neo-Hookean, 1 m x 0.125 m x 0.125 m, 5 % of it held"};
  table.columns = columns_after({"mesh", "directions start from"});
  std::vector<DirectionStart> starts = {{}};  // the paper's
  starts.insert(starts.end(), beside_the_papers.begin(), beside_the_papers.end());
  const std::vector<std::string> bar = {
      "body.bar.material={ model = 'stable-neo-hookean', young = 1e5, poisson = 0.4 }",
      "body.bar.handles.end.select={ box = [[0, 0, 0], [0.05, 1, 1]] }"};
  std::vector<std::pair<std::string, std::vector<std::string>>> meshes = {
      {"ours", {"body.bar.box={ extent = [1, 0.125, 0.125], cells = [40, 5, 5] }"}}};
  if (setting.paper_meshes)
    meshes.push_back(
        {"paper's",
         {fmt::format("body.bar.mesh={}", (*setting.paper_meshes / "longbar2.mesh").string()), "body.bar.size=1"}});
  for (auto& [name, settings] : meshes) {
    settings.insert(settings.end(), bar.begin(), bar.end());
    HangingBar hanging(settings, *setting.threads);
    say_doing(setting, fmt::format("slender bar, {} mesh: {}", name, hanging.subject.size_text()));
    for (const DirectionStart& start : starts) {
      for (const int iterations : {3, 5, 10}) {
        const Played played =
            play(hanging.subject, Method::quasi_newton, iterations, hanging_frames, *setting.threads, start);
        table.rows.push_back(hanging.row({name, text_of(start)}, iterations, played));
      }
    }
    for (const Method& method : {Method::newton, Method::newton_on_demand}) {
      for (const int iterations : {1, 2, 5})
        table.rows.push_back(hanging.row({name, name_of(method)}, iterations,
                                         play(hanging.subject, method, iterations, hanging_frames, *setting.threads)));
    }
  }
  return table;
}

}  // namespace

ReportSection bench_hanging(const BenchSetting& setting) {
  HangingBar bar({}, *setting.threads);
  ReportSection section{"hanging", "Where the tip of a hanging bar is after two seconds"};
  section.text = fmt::format(
      "A corotated bar, 1 m long, held at one end and let go ({}, E = 1e5 Pa, h = 1/30 s). Solved (400 "
      "iterations a step) its tip is at ({:.4f}, {:.4f}, {:.4f}) m.",
      bar.subject.size_text(), bar.solved.x(), bar.solved.y(), bar.solved.z());
  ReportTable table{"hanging", "The tip by method"};
  table.columns = columns_after({"method"});
  for (const DirectionStart& start : beside_the_papers) {
    for (const int iterations : {3, 5, 10, 20})
      table.rows.push_back(
          bar.row({fmt::format("quasi-newton, {}", text_of(start))}, iterations,
                  play(bar.subject, Method::quasi_newton, iterations, hanging_frames, *setting.threads, start)));
  }
  for (const Method& method : compared_methods()) {
    const bool newton = method.matrix == StartMatrix::hessian && method.linear == LinearSolver::direct;
    for (const int iterations : newton ? std::vector<int>{1, 2} : std::vector<int>{5, 10, 20})
      table.rows.push_back(bar.row({name_of(method)}, iterations,
                                   play(bar.subject, method, iterations, hanging_frames, *setting.threads)));
  }
  section.tables.push_back(std::move(table));
  section.tables.push_back(slender_table(setting));
  return section;
}

}  // namespace supple
