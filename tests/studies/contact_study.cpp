// Measures what the choices of docs/contact.md cost and gain in equal time, on the same states: it runs a scene with
// the defaults, and makes one step with each variant from each chosen state, in turns. It prints markdown.
// Usage: supple_contact_study ASSETS SCENE BODY EVERY FRAMES [PATH=VALUE...], where SCENE is a file and BODY a name
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "app/bench/subject.h"
#include "baselines/figure_rules.h"
#include "baselines/reference.h"
#include "output/run/profile.h"
#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"
#include "scene/reading/scene_reader.h"
#include "sim/measures/measures.h"
#include "sim/solver/iterations.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/step.h"
#include "world/world.h"

using namespace supple;

namespace {

constexpr int usual_iterations = 10;
constexpr int all_iterations = 30;
constexpr int timed_rounds = 3;
constexpr int most_for_newton = 9000;  // vertices; minima of larger bodies are found by L-BFGS alone

// Applies the low-rank correction without bending directions around planes that are near.
class StraightInverse final : public InitialInverse {
 public:
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override {
    system_.apply(model, inputs, workspace, r, z);
  }

 private:
  SystemInverse system_;
};

enum class Directions {
  ours,
  not_bent,  // around planes that are near
  papers,    // baselines/figure_rules.h
};

struct Variant {
  std::string name;
  SolverSettings solver;
  Directions directions = Directions::ours;
  bool same_energy = true;  // as the defaults: errors in equal time can be compared
  std::unique_ptr<OpenWorkspace> workspace = std::make_unique<OpenWorkspace>();
  // These values belong to one state: by iteration, the first iterate first.
  std::vector<double> gained = {}, least_ms = {};
  std::vector<double> usual_ms = {};  // of the usual number of iterations, by round
  Positions end = {};
  // These values belong to all states.
  std::vector<double> trials = {}, ms = {}, median_ms = {}, error = {}, error_in_time = {}, time_to_error = {},
                      depth = {};
  int failed = 0;

  std::size_t usual_end() const { return std::min<std::size_t>(usual_iterations, gained.size() - 1); }
};

std::vector<Variant> variants(const SolverSettings& usual) {
  std::vector<Variant> list;
  const auto add = [&](const std::string& name, bool same_energy = true) -> Variant& {
    Variant& variant = list.emplace_back();
    variant.name = name;
    variant.solver = usual;
    variant.solver.iterations = all_iterations;
    variant.same_energy = same_energy;
    return variant;
  };
  const auto add_papers = [&](const std::string& name, bool same_energy = true) -> Variant& {
    Variant& variant = add(name, same_energy);
    variant.directions = Directions::papers;
    variant.solver.levels = 1;
    return variant;
  };
  add("defaults");
  add("low-rank, not bent").directions = Directions::not_bent;
  add("diagonal").solver.contact.direction = ContactDirection::diagonal;
  add_papers("contacts in pairs, as the paper");
  add("no history (m = 0)").solver.history = 0;
  for (const double k : {10.0, 100.0, 1e3, 1e5}) add(fmt::format("k_c {:g}", k), false).solver.contact.stiffness = k;
  add_papers("the same, k_c 100", false).solver.contact.stiffness = 100;
  return list;
}

// Holds all that a step from one state needs.
struct Start {
  const Model& model;
  const StepInputs& inputs;
  const State& before;
  const Triangles& surface;
};

// Makes one step. The first round gives the results, and lets the variant build what it keeps from step to step.
void run(const Start& s, Variant& variant, int round, OpenWorkspace& scratch) {
  StepInputs inputs = s.inputs;
  inputs.solver = variant.solver;
  State after = s.before;
  SystemInverse bending;
  StraightInverse straight;
  LbfgsRule ours(variant.directions == Directions::ours ? static_cast<InitialInverse&>(bending) : straight);
  const auto papers = make_paper_rule(s.model);
  SearchRule& rule = variant.directions == Directions::papers ? *papers : ours;
  const StepReport report = step(s.model, inputs, after, *variant.workspace, rule);
  std::vector<double> ms = {report.start_ms};
  for (const IterationRecord& record : report.records) ms.push_back(record.elapsed_ms);
  if (round > 0) {
    for (std::size_t k = 0; k < ms.size(); ++k)
      variant.least_ms[k] = round == 1 ? ms[k] : std::min(variant.least_ms[k], ms[k]);
    variant.usual_ms.push_back(ms[variant.usual_end()]);
    return;
  }
  variant.failed += report.failed || report.stop_reason == StopReason::line_search_failed;
  variant.least_ms = ms;
  variant.usual_ms.clear();
  variant.end = after.x;
  double left = gained(s.model, inputs, s.before, after.x, scratch);
  variant.gained.assign(ms.size(), left);
  for (std::size_t k = ms.size() - 1; k-- > 0;) {
    left -= report.records[k].decrease;
    variant.gained[k] = left;
  }
  // The trials and the overlap are those of the usual number of iterations.
  inputs.solver.iterations = usual_iterations;
  after = s.before;
  variant.trials.push_back(step(s.model, inputs, after, *variant.workspace, rule).line_search);
  variant.depth.push_back(penetration(*inputs.colliders, inputs.collider_motions, after.x, s.surface) / s.model.size);
}

// Returns g(y) - g* of a state, found from the best final point of these variants.
double whole_gain(const Start& s, const std::vector<Variant*>& list, Reference& lowest, OpenWorkspace& scratch) {
  const Variant& best = **std::max_element(
      list.begin(), list.end(), [](const Variant* a, const Variant* b) { return a->gained.back() < b->gained.back(); });
  StepInputs inputs = s.inputs;
  inputs.solver = best.solver;
  if (s.model.vertices <= most_for_newton) return lowest.minimum(s.model, inputs, s.before, best.end, scratch).below_y;
  inputs.solver.iterations = 300;
  inputs.solver.history = 20;
  scratch.prepare(s.model, inputs.solver);
  scratch.report = StepReport{};
  const double reached = gained(s.model, inputs, s.before, best.end, scratch);
  minimize(s.model, inputs, scratch, 1e-12 * std::abs(reached));
  return reached + scratch.report.decrease;
}

// Adds the results of a variant from one state, relative to the defaults.
void add_results(Variant& variant, const Variant& usual, double whole) {
  const auto error = [&](const Variant& v, std::size_t k) { return (whole - v.gained[k]) / whole; };
  variant.error.push_back(error(variant, variant.usual_end()));
  std::sort(variant.usual_ms.begin(), variant.usual_ms.end());
  variant.ms.push_back(variant.least_ms[variant.usual_end()]);
  variant.median_ms.push_back(variant.usual_ms[variant.usual_ms.size() / 2]);
  if (!variant.same_energy) return;
  const double budget = usual.least_ms[usual.usual_end()], wanted = error(usual, usual.usual_end());
  std::size_t in_time = 0, reached = variant.gained.size();
  for (std::size_t k = 0; k < variant.gained.size(); ++k) {
    if (variant.least_ms[k] <= budget) in_time = k;
    if (reached == variant.gained.size() && error(variant, k) <= wanted) reached = k;
  }
  variant.error_in_time.push_back(error(variant, in_time));
  variant.time_to_error.push_back(reached < variant.gained.size() ? variant.least_ms[reached] / budget
                                                                  : std::numeric_limits<double>::infinity());
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += std::log(std::max(value, 1e-12));
  return std::exp(sum / static_cast<double>(values.size()));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print(const std::vector<Variant>& list) {
  fmt::print(
      "| variant | trials | ms, least | ms, median | error, mean | error, geometric mean | error in the defaults' "
      "time, "
      "mean | the same, geometric mean | time to the defaults' error | penetration, p95 | searches failed |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Variant& v : list) {
    const std::string timed = v.same_energy
                                  ? fmt::format("{:.1e} | {:.1e} | {:.2f}", distribution_of(v.error_in_time).mean,
                                                geometric_mean(v.error_in_time), median(v.time_to_error))
                                  : "| | ";
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.1e} | {:.1e} | {} | {:.1e} | {} |\n", v.name,
               distribution_of(v.trials).mean, distribution_of(v.ms).mean, distribution_of(v.median_ms).mean,
               distribution_of(v.error).mean, geometric_mean(v.error), timed, distribution_of(v.depth).p95, v.failed);
  }
}

// Compares all variants on the step from one state.
void compare(const Start& start, std::vector<Variant>& list, Reference& lowest, OpenWorkspace& scratch) {
  std::vector<Variant*> same;
  for (Variant& variant : list) {
    if (variant.same_energy) same.push_back(&variant);
  }
  for (int round = 0; round <= timed_rounds; ++round) {
    for (Variant& variant : list) run(start, variant, round, scratch);
  }
  const double whole = whole_gain(start, same, lowest, scratch);
  for (Variant& variant : list)
    add_results(variant, list.front(), variant.same_energy ? whole : whole_gain(start, {&variant}, lowest, scratch));
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 6) return 2;
  const SceneDef scene = load_scene(arguments[2], arguments[1], {arguments + 6, arguments + count});
  World world(scene, assemble(scene));
  const auto found = std::find_if(world.bodies().begin(), world.bodies().end(),
                                  [&](const Body& b) { return b.def.name == arguments[3]; });
  if (found == world.bodies().end()) {
    fmt::print(stderr, "{} has no body '{}'\n", arguments[2], arguments[3]);
    return 2;
  }
  Threads threads(2);
  world.start(scenes_own_solver(), &threads);
  MovingBody& body = world.body(std::size_t(found - world.bodies().begin()));
  const Model& model = body.model();
  Triangles surface = found->def.cloth ? found->cloth.surface.triangles : boundary_faces(found->description.mesh.tets);
  for (Eigen::Index i = 0; i < surface.size(); ++i) surface.data()[i] = model.internal_of[surface.data()[i]];
  std::vector<Variant> list = variants(found->def.solver.settings);
  OpenWorkspace scratch;
  scratch.threads = &threads;
  for (Variant& variant : list) variant.workspace->threads = &threads;
  Reference lowest(model);
  const int every = std::max(1, std::atoi(arguments[4]));
  for (int frame = 0; frame < std::atoi(arguments[5]); ++frame) {
    const State before = body.state();
    if (!world.play(frame)) return 1;
    if (frame % every != 0 || body.report().contacts.touching == 0) continue;
    const State after = body.state();
    body.restore(before);
    world.prepare(0);
    compare({model, body.inputs(), before, surface}, list, lowest, scratch);
    body.restore(after);
  }
  fmt::print("{}: {} vertices, {} states in contact\n\n", scene.name, model.vertices, list.front().error.size());
  if (!list.front().error.empty()) print(list);
  return 0;
}
