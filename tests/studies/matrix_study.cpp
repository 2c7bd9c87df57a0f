// Finds the numbers of the matrix that follows the body (sim/model/tangent_system.h, sim/solver/matrix_rule.h): on
// states of the scenes that ship, steps of ten iterations with matrices of several shares and ages. Prints a line each:
// scene, body, frame, matrix, departure, error of equation 12, that over the paper's matrix', trials, contacts, and
// half of the slope at the end over g(y) - g*.
//   supple_matrix_study [MOST_VERTICES] [SCENE...]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>

#include "app/bench/subject.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"
#include "sim/model/tangent_system.h"
#include "sim/solver/step.h"

using namespace supple;

namespace {

struct Variant {
  std::string name;
  TangentShares shares{0, 1};
  int age = -1;  // -2: the paper's matrix; else at q so many frames ago
};

struct Run {
  std::vector<double> gained;  // by iteration [J]
  Positions x;
  bool failed = false;
  int trials = 0;
  double decrement = 0;  // of the report [J]
};

Run run_once(Subject& subject, const StepInputs& given, const State& before, const Variant& variant,
             const Positions& place, OpenWorkspace& w, int iterations) {
  Run run;
  StepInputs inputs = given;
  inputs.solver.iterations = iterations;
  inputs.solver.matrix = StartMatrix::system;  // the matrix comes with the model
  State after = before;
  const StepReport* report = nullptr;
  w.correction = {};
  if (variant.age == -2) {
    report = &step(subject.model(), inputs, after, w);
  } else {
    static TangentSystem tangent;
    static Model copy;
    tangent.make(subject.model(), place, variant.shares, nullptr);
    copy = subject.model();
    static_cast<System&>(copy) = tangent.system();
    report = &step(copy, inputs, after, w);
  }
  run.failed = report->failed;
  if (run.failed) return run;
  run.trials = report->line_search;
  run.decrement = report->decrement;
  run.x = after.x;
  const std::vector<IterationRecord> records = report->records;
  OpenWorkspace scratch;
  double left = gained(subject.model(), inputs, before, run.x, scratch);
  run.gained.assign(records.size() + 1, left);
  for (std::size_t k = records.size(); k-- > 0;) {
    left -= records[k].decrease;
    run.gained[k] = left;
  }
  return run;
}

// One line a state and age: how stale the matrix is, error and trials over those of the paper's matrix.
void study(const std::string& scene, const std::string& body, int most_vertices, Threads& threads) {
  Subject subject({scene, body, {"solver.matrix=system"}});
  if (subject.model().vertices > most_vertices) return;
  const Model& model = subject.model();
  World world = subject.new_world(scenes_own_solver(), threads);
  const MovingBody& moving = world.body(0);
  std::deque<Positions> places, starts;
  Reference reference(model);
  OpenWorkspace w, scratch;
  for (int frame = 0; frame <= 70; ++frame) {
    world.enter(frame);
    world.prepare(0);
    const State before = moving.state();
    places.push_front(before.x + model.time_step * before.v);
    starts.push_front(before.x);
    if (places.size() > 17) {
      places.pop_back();
      starts.pop_back();
    }
    if (frame >= 17 && frame % 9 == 0) {
      std::vector<Run> runs;
      std::vector<std::string> labels;
      std::vector<double> stale;
      const auto add = [&](const std::string& label, const Variant& v, const Positions& place) {
        runs.push_back(run_once(subject, moving.inputs(), before, v, place, w, 10));
        labels.push_back(label);
        TangentSystem made;
        if (v.age != -2) made.make(model, place, v.shares, nullptr);
        stale.push_back(v.age == -2 ? 0 : made.departure(model, places[0]));
      };
      add("system", {"", {0, 1}, -2}, places[0]);
      for (const double axial : {0.0, 0.5, 0.7}) {
        for (const double share : {0.8, 0.95}) {
          for (const int age : {0, 1, 3, 8}) {
            if (share > 0.9 && age > 0) continue;
            add(fmt::format("{}/{}-{}", axial, share, age), {"", {share, 1 - share, axial}, 0}, places[age]);
          }
        }
      }
      add("half", {"", {0.8, 0.2, 0.5}, 0}, 0.5 * (starts[0] + places[0]));
      add("rest", {"", {0.8, 0.2, 0.5}, 0}, model.rest);
      const Run* best = &runs[0];
      for (const Run& r : runs)
        if (!r.failed && r.gained.back() > best->gained.back()) best = &r;
      const double whole = reference.minimum(model, moving.inputs(), before, best->x, scratch).below_y;
      const double scale = model.total_mass * std::pow(model.size / model.time_step, 2);
      if (whole > 1e-12 * scale) {
        for (std::size_t i = 0; i < runs.size(); ++i) {
          const auto error = [&](const Run& r) { return std::max((whole - r.gained.back()) / whole, 1e-15); };
          fmt::print("{},{},{},{},{:.4f},{:.2e},{:.3g},{},{},{:.2e}\n", scene, body, frame, labels[i], stale[i],
                     error(runs[i]), error(runs[i]) / error(runs[0]), runs[i].trials, w.report.contacts.touching,
                     runs[i].decrement / whole);
        }
        std::fflush(stdout);
      }
    }
    world.step();
  }
}

}  // namespace

int main(int count, char** arguments) {
  const int most_vertices = count > 1 ? std::atoi(arguments[1]) : 4000;
  Threads threads(1);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / "scenes")) files.push_back(entry);
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    if (count > 2 &&
        std::none_of(arguments + 2, arguments + count, [&](const char* n) { return n == file.stem().string(); }))
      continue;
    for (const BodyDef& def : load_scene(file, assets_folder(), {}).bodies)
      study(file.stem().string(), def.name, most_vertices, threads);
  }
  return 0;
}
