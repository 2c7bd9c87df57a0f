#include "app/bench/meeting_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "app/bench/case_text.h"
#include "app/bench/comparison.h"
#include "base/interrupts.h"
#include "film/record/body_recorder.h"
#include "film/record/pair_recorder.h"
#include "film/record/world_errors.h"
#include "output/run/row_tally.h"
#include "scene/building/body_depths.h"
#include "sim/measures/energies.h"
#include "sim/measures/measures.h"

namespace supple {
namespace {

constexpr double much_depth = DeepBodies::deep;  // over the smaller body's size
constexpr double at_rest = 0.1;                  // of a body's sizes a second
constexpr double most_pushed = 3;                // the same, of bodies that start in each other; push_out is 1

// Follows the energy of all bodies together. Contact between them may take energy, but gives none, except where it
// pushes bodies apart that start in each other. For those, a rule limits the speed at the end instead.
class EnergyOfAll {
 public:
  explicit EnergyOfAll(World& world) : world_(world) {
    for (std::size_t b = 0; b < world_.size(); ++b) workspaces_.push_back(std::make_unique<OpenWorkspace>());
  }

  // Looks at the present states.
  void look() {
    double total = 0, moved = 0;
    for (std::size_t b = 0; b < world_.size(); ++b) {
      const MovingBody& body = world_.body(b);
      OpenWorkspace& w = *workspaces_[b];
      w.prepare(body.model(), body.inputs().solver);
      const Energies of = energies(body.model(), body.state(), world_.scene().gravity, w);
      total += of.total();
      moved += of.kinetic + std::abs(of.elastic);
    }
    lowest_ = std::min(lowest_, total);
    exchanged_ = std::max(exchanged_, moved);
    if (exchanged_ > 0) gained_ = std::max(gained_, (total - lowest_) / exchanged_);
  }

  // Returns the energy from nothing over what was exchanged: the worst of all looks.
  double gained() const { return gained_; }

 private:
  World& world_;
  std::vector<std::unique_ptr<OpenWorkspace>> workspaces_;
  double lowest_ = std::numeric_limits<double>::infinity(), exchanged_ = 0, gained_ = 0;
};

// Makes the film of a scene without pictures, as the frame loop of films does (film/frame_loop.cpp), and looks at its
// states.
class MeetingRun {
 public:
  MeetingRun(const MeetingCase& meeting, SceneDef scene, const std::filesystem::path& folder, Threads& threads)
      : meeting_(meeting),
        world_(scene, assemble(scene)),
        folder_(folder),
        solvers_{scenes_own_solver(), {}, {}},
        errors_(world_, solvers_, threads),
        pairs_(world_, FrameRows()) {
    world_.start(solvers_.steps, &threads);
    for (std::size_t b = 0; b < world_.size(); ++b)
      recorders_.push_back(std::make_unique<BodyRecorder>(world_, b, &folder_, errors_));
  }

  MeetingOutcome play();

 private:
  std::string make_steps(int frame, FrameRow& row);
  bool is_finite() const;
  std::vector<Positions> places() const;
  void look_at_places(MeetingOutcome& outcome, int frame) const;
  void look_at_end(MeetingOutcome& outcome) const;

  const MeetingCase& meeting_;
  World world_;
  RunFolder folder_;
  FilmSolvers solvers_;
  WorldErrors errors_;
  PairRecorder pairs_;
  std::vector<std::unique_ptr<BodyRecorder>> recorders_;
};

// Makes the steps of a frame and completes its row. Returns why a step failed; empty when none did.
std::string MeetingRun::make_steps(int frame, FrameRow& row) {
  row.frame = frame;
  row.time_s = world_.scene().time_after(frame);
  row.bodies.resize(world_.size());
  for (std::size_t b = 0; b < world_.size(); ++b) recorders_[b]->begin_frame(frame, false, row.bodies[b]);
  const StepWatch watch{[this](std::size_t body, int substep) { recorders_[body]->before_step(substep); },
                        [this](std::size_t body, int substep) { recorders_[body]->after_step(substep); }};
  if (!world_.play(frame, watch)) {
    for (const auto& body : recorders_) {
      if (std::string failure = body->failure(); !failure.empty()) return failure;
    }
    return fmt::format("frame {}: a step failed", frame);
  }
  if (!is_finite()) return "";
  for (const auto& body : recorders_) body->end_frame();
  pairs_.record(row);
  return "";
}

bool MeetingRun::is_finite() const {
  for (std::size_t b = 0; b < world_.size(); ++b) {
    const State& state = world_.body(b).state();
    if (!state.x.allFinite() || !state.v.allFinite()) return false;
  }
  return true;
}

// Returns the positions of each body's mesh.
std::vector<Positions> MeetingRun::places() const {
  std::vector<Positions> list;
  for (std::size_t b = 0; b < world_.size(); ++b)
    list.push_back(in_input_order(world_.body(b).model(), world_.body(b).state().x));
  return list;
}

// Notes how deep the bodies are in each other, and whether they are in their order.
void MeetingRun::look_at_places(MeetingOutcome& outcome, int frame) const {
  const std::vector<Positions> points = places();
  outcome.depth_at_end = 0;
  outcome.crossed_at_end = false;
  for (const BodyDepth& pair : overlaps_of_bodies(world_.bodies(), points)) {
    outcome.depth_at_end = std::max(outcome.depth_at_end, pair.share);
    outcome.crossed_at_end = outcome.crossed_at_end || pair.depth <= 0;
  }
  outcome.deepest = std::max(outcome.deepest, outcome.depth_at_end);
  if (meeting_.order.isZero() || frame >= meeting_.ordered_frames || !outcome.passed.empty()) return;
  for (std::size_t b = 1; b < points.size(); ++b) {
    const Vec3 way = (points[b].colwise().mean() - points[b - 1].colwise().mean()).transpose();
    const double along = way.dot(meeting_.order);
    if (along > 0 || (way - along * meeting_.order).norm() > meeting_.around) continue;
    outcome.passed = fmt::format("'{}' and '{}'", world_.bodies()[b - 1].def.name, world_.bodies()[b].def.name);
    return;
  }
}

void MeetingRun::look_at_end(MeetingOutcome& outcome) const {
  for (std::size_t b = 0; b < world_.size(); ++b) {
    const Model& model = world_.body(b).model();
    const State& state = world_.body(b).state();
    const Deformation shape = deformation(model, state.x);
    outcome.inverted += shape.inverted;
    outcome.collapsed += shape.collapsed;
    double sum = 0;
    for (int v = 0; v < model.free; ++v) sum += model.mass[std::size_t(v)] * state.v.row(v).squaredNorm();
    outcome.speed = std::max(outcome.speed, std::sqrt(sum / model.total_mass) / model.size);
  }
}

MeetingOutcome MeetingRun::play() {
  MeetingOutcome outcome;
  look_at_places(outcome, 0);
  outcome.started_inside = outcome.deepest > 0 || outcome.crossed_at_end;
  outcome.deepest = 0;
  EnergyOfAll energy(world_);
  if (meeting_.alone_from <= 0) energy.look();
  RowTally tally;
  for (int frame = 0; frame < world_.scene().frames && outcome.finite; ++frame) {
    FrameRow row;
    const std::string failed = make_steps(frame, row);
    if (!failed.empty()) outcome.warnings.push_back(failed);
    outcome.finite = failed.empty() && is_finite();
    if (!outcome.finite) break;
    look_at_places(outcome, frame);
    if (world_.scene().time_after(frame) >= meeting_.alone_from) energy.look();
    outcome.trials += double(row.bodies.front().line_search) / world_.scene().frames;
    tally.add(row);
  }
  outcome.gained = energy.gained();
  if (outcome.finite) look_at_end(outcome);
  for (std::string& warning : tally.warnings()) outcome.warnings.push_back(std::move(warning));
  return outcome;
}

// Names the rule that a run breaks; empty: none.
std::string broken_rule(const MeetingOutcome& outcome, const MeetingCase& meeting) {
  if (!outcome.finite) return "not finite";
  if (!outcome.started_inside && outcome.gained > much_energy)
    return fmt::format("{:.0f} % energy from nothing", 100 * outcome.gained);
  if (!outcome.passed.empty()) return outcome.passed + " passed each other";
  if (outcome.depth_at_end > much_depth) return fmt::format("{:.1f} % deep in each other", 100 * outcome.depth_at_end);
  if (outcome.started_inside && outcome.crossed_at_end) return "edges still cross";
  if (outcome.started_inside && outcome.speed > most_pushed)
    return fmt::format("thrown apart by {:.2g} sizes a second", outcome.speed);
  if (meeting.stays_whole && outcome.inverted > 0) return fmt::format("{} inverted", outcome.inverted);
  if (meeting.stays_whole && outcome.collapsed > 0) return fmt::format("{} without volume", outcome.collapsed);
  if (meeting.comes_to_rest && outcome.speed > at_rest)
    return fmt::format("still moves by {:.2g} sizes a second", outcome.speed);
  return "";
}

// Returns the text of a scene with a material for each of its bodies.
std::string with_materials(std::string text, const MeetingCase& meeting, const NamedMaterial& material) {
  const std::string word = "MATERIAL";
  for (std::size_t body = 0; text.find(word) != std::string::npos; ++body) {
    const double stiffer = body < meeting.stiffness.size() ? meeting.stiffness[body] : 1;
    text = filled(std::move(text), word, material_table(material.name, stiffer * usual_young, usual_poisson).value());
  }
  return text;
}

}  // namespace

std::vector<MeetingOutcome> run_meeting(const MeetingCase& meeting, const NamedMaterial& material, int substeps,
                                        const std::filesystem::path& folder, Threads& threads) {
  std::vector<MeetingOutcome> outcomes;
  for (const std::string& scene : meeting.scenes) {
    if (interrupted()) throw BenchInterrupted{};
    const std::string text = fmt::format("substeps = {}\n", substeps) + with_materials(scene, meeting, material);
    MeetingRun run(meeting, scene_of_case(text), folder, threads);
    outcomes.push_back(run.play());
    outcomes.back().failure = broken_rule(outcomes.back(), meeting);
  }
  return outcomes;
}

}  // namespace supple
