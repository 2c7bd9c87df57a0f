// Measures what contact between bodies costs in the scenes that ship, how deep and how exact it is, beside scenes whose
// bodies touch colliders and no other bodies.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"
#include "baselines/joined_reference.h"
#include "film/plan/shipped_files.h"
#include "film/record/world_errors.h"
#include "scene/reading/scene_reader.h"
#include "sim/measures/measures.h"

namespace supple {
namespace {

constexpr int plays = 2;           // of each film; of each frame, the quickest play counts
constexpr int measured_steps = 6;  // frames whose last steps are repeated by the reference

// Measures the errors of the steps that a body makes alone.
class AloneMeter : public ErrorMeter {
 public:
  AloneMeter(const Model& model, Threads& threads) : reference_(model) { workspace_.threads = &threads; }

  MeasuredErrors step_errors(const Model& model, const StepInputs& inputs, const State& before,
                             const State& after) override {
    const auto [error, motion] = reference_.step_errors(model, inputs, before, after, workspace_);
    return {error, motion, true};
  }

 private:
  Reference reference_;
  OpenWorkspace workspace_;
};

FilmSolvers measuring_solvers() {
  return {scenes_own_solver(),
          [](const Model& model, Threads& threads) { return std::make_unique<AloneMeter>(model, threads); },
          [](const Model& joined, const StepInputs& inputs, const State& before, const State& after, Threads& threads) {
            OpenWorkspace workspace;
            workspace.threads = &threads;
            const JoinedErrors errors = joined_errors(joined, inputs, before, after, workspace);
            std::vector<MeasuredErrors> list;
            for (const double motion : errors.motion) list.push_back({errors.error, motion, errors.converged});
            return list;
          }};
}

// Holds what was measured of the steps of some frames.
struct StepsMeasured {
  std::vector<double> error, motion;  // errors of each island and each body alone; errors of motion of each body
  int unsure = 0;                     // references that did not converge
};

// Plays a film again, and measures the last step of some frames.
StepsMeasured measure_steps(const SceneDef& scene, const std::vector<Body>& bodies, Threads& threads) {
  TouchingFilm film(scene, bodies, threads);
  const FilmSolvers solvers = measuring_solvers();
  WorldErrors errors(film.world(), solvers, threads);
  StepsMeasured measured;
  const auto is_measured = [&](int substep) {
    const int every = std::max(1, scene.frames / measured_steps);
    return substep + 1 == scene.substeps && film.frames() % every == every / 2;
  };
  const auto prepared = [&](std::size_t body, int substep) {
    if (is_measured(substep)) errors.before_step(body);
  };
  const auto made = [&](std::size_t body, int substep) {
    const MovingBody& moved = film.world().body(body);
    if (!is_measured(substep) || moved.report().failed) return;
    const std::optional<MeasuredErrors> found = errors.of_step(body);
    if (!found) return;
    measured.motion.push_back(found->motion);
    if (moved.is_in_island() && film.world().joined_step().bodies.front() != body) return;
    if (found->error) measured.error.push_back(*found->error);
    measured.unsure += !found->converged;
  };
  while (film.frames() < scene.frames && film.play({prepared, made})) {
  }
  return measured;
}

// Holds what is seen of a film.
struct FilmSeen {
  int bodies = 0, vertices = 0;
  double ms = 0;  // of the steps of a frame, mean
  int contacts = 0, collider_contacts = 0;
  std::vector<double> depths, collider_depths;  // by frame and pair, over the smaller size
  double trials = 0;                            // an iteration
  double at_rest = 0;                           // kinetic energy at the end over its largest
  bool failed = false;
};

// Adds how deep each body is in each collider that it touches, over the body's size.
void add_collider_depths(TouchingFilm& film, std::vector<double>& depths) {
  for (std::size_t b = 0; b < film.world().size(); ++b) {
    const MovingBody& body = film.world().body(b);
    for (const double depth : penetrations(film.world().colliders().colliders, body.inputs().collider_motions,
                                           body.state().x, body.model().surface)) {
      if (depth > 0) depths.push_back(depth / body.model().size);
    }
  }
}

FilmSeen watch_film(const SceneDef& scene, const std::vector<Body>& bodies, Threads& threads) {
  FilmSeen seen;
  seen.bodies = static_cast<int>(bodies.size());
  std::vector<double> ms(std::size_t(scene.frames), 1e300);
  for (int play = 0; play < plays; ++play) {
    TouchingFilm film(scene, bodies, threads);
    int iterations = 0, trials = 0;
    double most_kinetic = 0;
    while (film.frames() < scene.frames) {
      if (!film.play()) {
        seen.failed = true;
        return seen;
      }
      const TouchingWork& work = film.work();
      ms[std::size_t(film.frames() - 1)] = std::min(ms[std::size_t(film.frames() - 1)], work.ms);
      if (play > 0) continue;
      iterations += work.iterations;
      trials += work.trials;
      seen.contacts = std::max(seen.contacts, work.contacts);
      seen.collider_contacts = std::max(seen.collider_contacts, work.collider_contacts);
      seen.depths.insert(seen.depths.end(), work.depths.begin(), work.depths.end());
      add_collider_depths(film, seen.collider_depths);
      most_kinetic = std::max(most_kinetic, film.kinetic_energy());
    }
    if (play > 0) continue;
    seen.trials = double(trials) / std::max(1, iterations);
    seen.at_rest = film.kinetic_energy() / most_kinetic;
    for (std::size_t b = 0; b < film.world().size(); ++b) seen.vertices += film.world().body(b).model().vertices;
  }
  for (const double frame : ms) seen.ms += frame / scene.frames;
  return seen;
}

struct CostScene {
  const char* name;
  bool meets;      // whether its bodies touch each other
  int frames = 0;  // that are played; zero for as many as the scene has
};

SceneDef shipped_scene(const std::string& name, const std::vector<std::string>& settings) {
  return load_scene(scene_file(name), assets_folder(), settings);
}

std::vector<std::string> settings_of(const CostScene& of) {
  if (of.frames == 0) return {};
  return {fmt::format("frames={}", of.frames)};
}

// Returns the time of a frame where no two bodies meet [ms].
double ms_apart(const SceneDef& meeting, const CostScene& of, Threads& threads) {
  std::vector<std::string> settings = settings_of(of);
  for (const BodyDef& body : meeting.bodies) settings.push_back(fmt::format("body.{}.contact.meets=false", body.name));
  const SceneDef apart = shipped_scene(of.name, settings);
  const FilmSeen seen = watch_film(apart, assemble(apart), threads);
  return seen.failed ? std::nan("") : seen.ms;
}

std::vector<std::string> cost_row(const CostScene& of, const BenchSetting& setting) {
  const SceneDef scene = shipped_scene(of.name, settings_of(of));
  const std::vector<Body> bodies = assemble(scene);
  const FilmSeen seen = watch_film(scene, bodies, *setting.threads);
  if (seen.failed) return {of.name, "failed"};
  const double apart = of.meets ? ms_apart(scene, of, *setting.threads) : std::nan("");
  say_doing(setting, fmt::format("{}: errors of some steps", of.name));
  const StepsMeasured steps = measure_steps(scene, bodies, *setting.threads);
  const std::vector<double>& depths = of.meets ? seen.depths : seen.collider_depths;
  const int contacts = of.meets ? seen.contacts : seen.collider_contacts;
  return {of.name,
          of.meets ? "each other" : "colliders",
          std::to_string(seen.bodies),
          std::to_string(seen.vertices),
          number_text(seen.ms),
          number_text(apart),
          number_text(seen.ms / apart),
          of.meets ? "3" : "",
          std::to_string(contacts),
          number_text(100 * rank_of(depths, 0.99)),
          "1",
          number_text(100 * rank_of(depths, 1)),
          number_text(seen.trials),
          "1.5",
          number_text(rank_of(steps.error, 0.5)),
          number_text(rank_of(steps.error, 1)),
          number_text(rank_of(steps.motion, 0.5)),
          number_text(rank_of(steps.motion, 1)),
          fmt::format("{} of {}", steps.unsure, steps.error.size()),
          number_text(seen.at_rest),
          "1e-4"};
}

}  // namespace

ReportTable touching_cost_table(const BenchSetting& setting) {
  ReportTable table{"touching-cost", "Scenes that ship: bodies that touch each other, and bodies that touch colliders"};
  table.note = fmt::format(
      "The time is that of all steps of a frame, with finding who may touch whom; each film is played {} times, and of "
      "each frame the quickest counts; bowl goes on to 300 frames. \"Apart\" is the same scene with contact = {{ meets "
      "= false }} in every body. "
      "Contacts are points that touch another body at the end of a frame (or colliders, where bodies touch nothing "
      "else); depths are those of every pair in every frame, over the smaller body's size. Errors are those of the "
      "last "
      "steps of about {} frames, spread evenly, against the reference of --error-every: equation 12 of each step, and "
      "the error of motion of each body. Where a reference did not converge, errors may be larger than the table says. "
      "At rest: kinetic energy at the end of the film over its largest.",
      plays, measured_steps);
  table.columns = {"scene",
                   "touch",
                   "bodies",
                   "vertices",
                   "a frame [ms]",
                   "apart [ms]",
                   "over apart",
                   "over apart, aim: below",
                   "contacts, most",
                   "depth, 99th percentile [%]",
                   "depth, aim: below [%]",
                   "deepest [%]",
                   "trials an iteration",
                   "trials, aim: below",
                   "error, median",
                   "error, worst",
                   "error of motion, median",
                   "error of motion, worst",
                   "references that did not converge",
                   "kinetic energy at the end",
                   "at rest, aim: below"};
  for (const CostScene& of : {CostScene{"bunny-on-bunny", true},
                              {"chain", true},
                              {"bowl", true, 300},
                              {"bunny-torus", false},
                              {"cubes-on-ground", false},
                              {"cloth-sphere", false}}) {
    say_doing(setting, of.name);
    std::vector<std::string> row = cost_row(of, setting);
    row.resize(table.columns.size());
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace supple
