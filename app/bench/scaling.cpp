#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/bench/fitted_exponent.h"
#include "app/bench/sections.h"
#include "base/timing.h"

namespace supple {
namespace {

constexpr int moving_frame = 20;  // the bar's ends have begun to turn

// Returns cells of the twisting bar, in its own proportions, that give about so many vertices.
Eigen::Vector3i cells_for(double vertices) {
  const auto count = [](int k) { return (std::lround(2.8 * k) + 1.0) * (k + 1) * (k + 1); };
  int k = 2;
  while (count(k) < vertices) ++k;
  if (vertices / count(k - 1) < count(k) / vertices) --k;
  return {static_cast<int>(std::lround(2.8 * k)), k, k};
}

template <class T>
double bytes_of(const std::vector<T>& list) {
  return double(sizeof(T)) * double(list.size());
}
template <class T>
double bytes_of(const AlignedVector<T>& list) {
  return double(sizeof(T)) * double(list.size());
}
double bytes_of(const Positions& rows) { return double(sizeof(double)) * double(rows.size()); }

// Holds what a step reads and writes of a body, by kind [bytes].
struct Memory {
  double elements, factor, vectors;
};

Memory memory_of(const Model& model, const OpenWorkspace& w) {
  const double number = model.factor.precision() == Precision::single_precision ? sizeof(float) : sizeof(double);
  Memory memory{};
  memory.elements = bytes_of(model.field) + bytes_of(model.corner) + bytes_of(model.chunk_vertex) +
                    bytes_of(model.slots) + bytes_of(model.slot_begin) + bytes_of(w.force) + bytes_of(w.local) +
                    bytes_of(w.current.energy) + bytes_of(w.trial.energy);
  memory.factor = number * double(model.factor.stored_numbers());
  for (const Positions* rows : {&w.y, &w.start_copy, &w.target, &w.current.x, &w.current.gradient, &w.trial.x,
                                &w.trial.gradient, &w.direction, &w.scratch, &w.middle})
    memory.vectors += bytes_of(*rows);
  for (const Positions& rows : w.step_pairs) memory.vectors += bytes_of(rows);
  for (const Positions& rows : w.gradient_pairs) memory.vectors += bytes_of(rows);
  return memory;
}

// Holds what was measured for one size of body.
struct Size {
  double vertices = 0, elements = 0, build_ms = 0;
  Memory memory{};
  StepReport one, two;  // the quickest step with one thread and with two
};

StepReport quickest_step(const Model& model, const StepInputs& inputs, const State& before, OpenWorkspace& w,
                         int repeats) {
  StepReport best;
  for (int i = 0; i <= repeats; ++i) {
    State state = before;
    const StepReport& report = step(model, inputs, state, w);
    if (i == 1 || (i > 1 && report.step_ms < best.step_ms)) best = report;
  }
  return best;
}

Size measure(double vertices, const BenchSetting& setting) {
  const Eigen::Vector3i cells = cells_for(vertices);
  Subject subject(
      {"twisting-bar", "bar", {fmt::format("body.bar.box.cells=[{}, {}, {}]", cells.x(), cells.y(), cells.z())}});
  say_doing(setting, subject.size_text());
  const BenchState state = states_of(subject, {moving_frame}, setting).front();
  const StepInputs inputs = subject.inputs(state);
  Size size;
  size.vertices = subject.model().vertices;
  size.elements = subject.model().elements;
  const int repeats = vertices < 20000 ? 15 : 5;
  for (const int count : {1, 2}) {
    Threads threads(count);
    OpenWorkspace w;
    w.threads = &threads;
    (count == 1 ? size.one : size.two) = quickest_step(subject.model(), inputs, state.before, w, repeats);
    size.memory = memory_of(subject.model(), w);
  }
  const Stopwatch watch;
  const Model again = build_model(subject.body().description);
  size.build_ms = watch.elapsed_ms();
  return size;
}

struct Quantity {
  const char* name;
  std::function<double(const Size&)> value;
};

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> list = {
      {"step, 1 thread [ms]", [](const Size& s) { return s.one.step_ms; }},
      {"step, 2 threads [ms]", [](const Size& s) { return s.two.step_ms; }},
      {"evaluate, 1 thread [ms]", [](const Size& s) { return s.one.evaluate_ms; }},
      {"solve, 1 thread [ms]", [](const Size& s) { return s.one.solve_ms; }},
      {"L-BFGS, 1 thread [ms]", [](const Size& s) { return s.one.lbfgs_ms; }},
      {"building the model, with its factor [ms]", [](const Size& s) { return s.build_ms; }},
      {"elements [bytes]", [](const Size& s) { return s.memory.elements; }},
      {"factor [bytes]", [](const Size& s) { return s.memory.factor; }},
      {"vectors [bytes]", [](const Size& s) { return s.memory.vectors; }}};
  return list;
}

}  // namespace

ReportSection bench_scaling(const BenchSetting& setting) {
  std::vector<Size> sizes;
  for (const double vertices : {1000, 2000, 5000, 10000, 20000, 50000, 100000})
    sizes.push_back(measure(vertices, setting));

  ReportSection section{"scaling", "Milliseconds and bytes against vertices"};
  ReportTable table{"scaling", "The twisting bar, finer and finer"};
  table.columns = {"vertices", "tetrahedra"};
  for (const Quantity& quantity : quantities()) table.columns.emplace_back(quantity.name);
  for (const Size& size : sizes) {
    std::vector<std::string> row = {number_text(size.vertices), number_text(size.elements)};
    for (const Quantity& quantity : quantities()) row.push_back(number_text(quantity.value(size)));
    table.rows.push_back(std::move(row));
  }
  section.tables.push_back(std::move(table));

  ReportTable exponents{"scaling-exponents", "Exponents p of vertices^p, by least squares over all sizes"};
  exponents.columns = {"quantity", "p"};
  for (const Quantity& quantity : quantities())
    exponents.rows.push_back(
        {quantity.name, number_text(fitted_exponent(sizes, std::mem_fn(&Size::vertices), quantity.value))});
  section.tables.push_back(std::move(exponents));

  ReportPlot plot{"scaling-step", "A step of ten iterations against the number of vertices"};
  plot.x_label = "vertices";
  plot.y_label = "time [ms]";
  plot.log_x = true;
  for (std::size_t q = 0; q < 5; ++q) {
    PlotSeries series{quantities()[q].name};
    series.thick = q == 0;
    for (const Size& size : sizes) {
      series.x.push_back(size.vertices);
      series.y.push_back(quantities()[q].value(size));
    }
    plot.series.push_back(std::move(series));
  }
  section.plots.push_back(std::move(plot));
  section.text = fmt::format(
      "The twisting bar in frame {}, with the scene's own solver; the least of several steps from one state. A factor "
      "by nested dissection of a body in three dimensions has of the order of n^(4/3) numbers (George 1973), so its "
      "share of a step grows with the body.",
      moving_frame);
  return section;
}

}  // namespace supple
