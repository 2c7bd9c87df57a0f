#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "baselines/figure_rules.h"
#include "sim/measures/measures.h"

namespace supple {
namespace {

constexpr double torn = 1000;  // the stretch above which a body counts as torn

struct ShakenRun {
  std::vector<double> stretch;  // by frame; shorter than asked when a step failed
  int failed_at = -1;           // the frame in which a step failed or the body was torn
  double ms = 0;                // median of a step
};

Solvers hecht_solver(int iterations) {
  return {[](const Method&, const Model& model) { return make_hecht_rule(model); },
          [iterations](const Method&, SolverSettings settings) {
            settings.iterations = iterations;
            return hecht_settings(settings);
          }};
}

ShakenRun shake(Subject& subject, const Solvers& solvers, int frames, Threads& threads) {
  ShakenRun result;
  World world = subject.new_world(solvers, threads);
  const MovingBody& body = world.body(0);
  std::vector<double> times;
  for (int frame = 0; frame < frames && result.failed_at < 0; ++frame) {
    const bool made = world.play(frame, {{}, [&](std::size_t, int) {
                                           if (!body.report().failed) times.push_back(body.report().step_ms);
                                         }});
    if (made) result.stretch.push_back(deformation(body.model(), body.state().x).stretch);
    if (!made || !(result.stretch.back() < torn)) result.failed_at = frame;
  }
  if (!times.empty()) {
    std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
    result.ms = times[times.size() / 2];
  }
  return result;
}

}  // namespace

ReportSection bench_figure10(const BenchSetting& setting) {
  const SubjectChoice ours{"shaking-bar", "bar"};
  const SubjectChoice choice = with_paper_mesh(setting, ours, "longbar.mesh").value_or(ours);
  ReportSection section{"figure10", "Figure 10: a bar shaken hard"};
  ReportTable table{"figure10", "What becomes of the bar"};
  table.columns = {
      "drive", "method", "iterations", "frames", "ends", "largest stretch (99.9th percentile)", "a step, median [ms]"};
  std::string sizes;
  for (const auto& [name, amount] : std::vector<std::pair<std::string, double>>{{"as in the film", 1}, {"twice", 2}}) {
    SubjectChoice driven = choice;
    std::string keys = "body.bar.handles.middle.keys=[{ t = 0.5 }";
    for (int k = 0; k < 12; ++k)
      keys += fmt::format(", {{ t = {:.4f}, move = [0, {:g}, 0] }}", 0.8333 + k / 3.0, k % 2 == 0 ? 20 * amount : 0.0);
    driven.settings.push_back(keys + "]");
    Subject subject(driven);
    sizes = subject.size_text();
    constexpr int frames = 150;
    ReportPlot plot{fmt::format("figure10-{}", amount > 1 ? "harder" : "film"),
                    fmt::format("Stretch by frame, driven {}", name)};
    plot.x_label = "frame";
    plot.y_label = "stretch (99.9th percentile)";
    plot.y_min = 1;
    plot.y_max = 1e4;
    struct Shaken {
      std::string label;
      Solvers solvers;
      int iterations;
    };
    for (const Shaken& shaken :
         {Shaken{"ours", solver_instead(Method::quasi_newton, 10), 10},
          Shaken{"Hecht et al., 1 solve", hecht_solver(1), 1}, Shaken{"Hecht et al., 10 solves", hecht_solver(10), 10},
          Shaken{"Newton", solver_instead(Method::newton, 2), 2}}) {
      const ShakenRun result = shake(subject, shaken.solvers, frames, *setting.threads);
      PlotSeries curve{shaken.label};
      curve.thick = shaken.label == "ours";
      for (std::size_t k = 0; k < result.stretch.size(); ++k) {
        curve.x.push_back(static_cast<double>(k));
        curve.y.push_back(result.stretch[k]);
      }
      plot.series.push_back(curve);
      const double most =
          result.stretch.empty() ? std::nan("") : *std::max_element(result.stretch.begin(), result.stretch.end());
      table.rows.push_back({name, shaken.label, std::to_string(shaken.iterations), std::to_string(frames),
                            result.failed_at < 0 ? "whole" : fmt::format("explodes in frame {}", result.failed_at),
                            number_text(most), number_text(result.ms)});
    }
    section.plots.push_back(std::move(plot));
  }
  section.text = fmt::format(
      "Corotated bar held in the middle ({}). Hecht et al.: the warped Hessian of the whole bar, factored anew every "
      "other step, in between turned at each vertex; no line search, as published. Stretches and failures as they "
      "come.",
      sizes);
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace supple
