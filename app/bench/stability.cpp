#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/bench.h"
#include "sim/model/measures.h"

namespace supple {
namespace {

constexpr double torn = 1000;  // a stretch beyond which nothing is left to save

struct Ride {
  std::vector<double> stretch;  // by frame; shorter than asked when it failed
  int failed_at = -1;           // the frame in which it failed or was torn
  double ms = 0;                // median of a step
};

Ride ride(const Subject& subject, Method method, int iterations, int frames, Threads& threads) {
  Ride result;
  State state = start_state(subject.model, subject.body);
  Workspace workspace;
  workspace.threads = &threads;
  const auto rule = make_rule(method, subject.model);
  std::vector<double> times;
  for (int frame = 0; frame < frames; ++frame) {
    FrameInputs inputs = subject.inputs(frame);
    inputs.solver.iterations = iterations;
    inputs.solver = settings_of(method, inputs.solver);
    const StepReport& report = step(subject.model, inputs, state, workspace, *rule);
    if (report.failed) {
      result.failed_at = frame;
      break;
    }
    times.push_back(report.step_ms);
    result.stretch.push_back(deformation(subject.model, state.x).stretch);
    if (!(result.stretch.back() < torn)) {
      result.failed_at = frame;
      break;
    }
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
  const SubjectChoice choice = setting.with_paper_mesh(ours, "longbar.mesh").value_or(ours);
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
    const Subject subject(driven);
    sizes = subject.size_text();
    constexpr int frames = 150;
    ReportPlot plot{fmt::format("figure10-{}", amount > 1 ? "harder" : "film"),
                    fmt::format("Stretch by frame, driven {}", name)};
    plot.x_label = "frame";
    plot.y_label = "stretch (99.9th percentile)";
    plot.y_min = 1;
    plot.y_max = 1e4;
    struct Rider {
      const char* label;
      Method method;
      int iterations;
    };
    for (const Rider& rider :
         {Rider{"ours", Method::quasi_newton, 10}, Rider{"Hecht et al., 1 solve", Method::hecht, 1},
          Rider{"Hecht et al., 10 solves", Method::hecht, 10}, Rider{"Newton", Method::newton, 2}}) {
      const Ride result = ride(subject, rider.method, rider.iterations, frames, *setting.threads);
      PlotSeries curve{rider.label};
      curve.thick = rider.method == Method::quasi_newton;
      for (std::size_t k = 0; k < result.stretch.size(); ++k) {
        curve.x.push_back(static_cast<double>(k));
        curve.y.push_back(result.stretch[k]);
      }
      plot.series.push_back(curve);
      const double most =
          result.stretch.empty() ? std::nan("") : *std::max_element(result.stretch.begin(), result.stretch.end());
      table.rows.push_back({name, rider.label, std::to_string(rider.iterations), std::to_string(frames),
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
