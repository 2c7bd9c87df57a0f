#include "app/bench/turning_films.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "base/interrupts.h"
#include "scene/building/collision_set.h"

namespace supple {
namespace {

// These "path=value" settings make the films of a case. Our method has the settings of a scene that sets nothing.
std::vector<std::string> our_settings() { return {}; }
std::vector<std::string> paper_settings() { return {"solver.levels=1"}; }
std::vector<std::string> solved_settings() { return {"solver.iterations=200"}; }
std::vector<std::string> settings_again() { return {"solver.iterations=400"}; }

State spun(const Model& model, State state, const Vec3& spin) {
  const Vec3 center = mass_mean(model, state.x);
  for (int v = 0; v < model.vertices; ++v)
    state.v.row(v) += spin.cross(state.x.row(v).transpose() - center).transpose();
  return state;
}

TurningFilm play(const TurningCase& turning, const std::vector<std::string>& settings, Threads& threads) {
  if (interrupted()) throw BenchInterrupted{};
  const SceneDef scene = scene_of_text(turning.scene, "turning body", settings);
  World world(scene, assemble(scene));
  world.start(scenes_own_solver(), &threads);
  MovingBody& body = world.body(0);
  const Model& model = body.model();
  body.restore(spun(model, body.state(), turning.spin));
  TurningFilm film;
  film.vertices = model.vertices;
  film.seen.push_back(turning.observe(model, body.state()));
  int iterations = 0, trials = 0;
  for (int frame = 0; frame < scene.frames; ++frame) {
    const bool made = world.play(frame, {{}, [&](std::size_t, int) {
                                           const StepReport& report = body.report();
                                           iterations += report.iterations;
                                           trials += report.line_search;
                                           film.step_ms += report.step_ms / (scene.frames * scene.substeps);
                                           film.error_estimate = std::max(film.error_estimate, report.error_estimate);
                                         }});
    if (!made) break;
    film.seen.push_back(turning.observe(model, body.state()));
  }
  film.seen.resize(std::size_t(scene.frames) + 1, Vec3::Constant(std::nan("")));
  film.trials = double(trials) / std::max(iterations, 1);
  return film;
}

MotionCurve curve_of(const TurningFilm& film, int coordinate) {
  MotionCurve curve(Eigen::Index(film.seen.size()));
  for (Eigen::Index k = 0; k < curve.size(); ++k) curve[k] = film.seen[std::size_t(k)][coordinate];
  return curve;
}

MotionCurve without_jumps(MotionCurve angle) {
  for (Eigen::Index k = 1; k < angle.size(); ++k)
    angle[k] = angle[k - 1] + std::remainder(angle[k] - angle[k - 1], 360.0);
  return angle;
}

// Returns the largest difference of all frames, in a unit that may differ from frame to frame; NaN for failed films.
double worst_difference(const MotionCurve& curve, const MotionCurve& solved, const MotionCurve& unit) {
  return ((curve - solved).abs() / unit).maxCoeff<Eigen::PropagateNaN>();
}

TableCells columns_of(const MotionQuantity& quantity) {
  TableCells columns;
  for (const char* whose : {"ours", "paper's", "solved again"})
    columns.push_back(fmt::format("{}, {} from solved, worst [{}]", quantity.name, whose, quantity.unit_of_difference));
  for (const char* whose : {"ours", "paper's", "solved"})
    columns.push_back(fmt::format("{}, {}, at the end [{}]", quantity.name, whose, quantity.unit));
  return columns;
}

const TableCells cost_columns = {"vertices",          "ours, trials an iteration", "paper's, trials an iteration",
                                 "ours, a step [ms]", "paper's, a step [ms]",      "solved, largest error estimate"};

}  // namespace

Vec3 mass_mean(const Model& model, const Positions& rows) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (int v = 0; v < model.vertices; ++v) {
    sum += model.mass[std::size_t(v)] * rows.row(v).transpose();
    mass += model.mass[std::size_t(v)];
  }
  return sum / mass;
}

TurningFilms play_films(const TurningCase& turning, const std::string& name, const BenchSetting& setting) {
  say_doing(setting, name);
  Threads& threads = *setting.threads;
  return {play(turning, our_settings(), threads), play(turning, paper_settings(), threads),
          play(turning, solved_settings(), threads), play(turning, settings_again(), threads)};
}

MotionCurves curves_of(const TurningFilms& films, int coordinate) {
  return {curve_of(films.ours, coordinate), curve_of(films.papers, coordinate), curve_of(films.solved, coordinate),
          curve_of(films.again, coordinate)};
}

MotionCurves without_jumps(const MotionCurves& angles) {
  return {without_jumps(angles.ours), without_jumps(angles.papers), without_jumps(angles.solved),
          without_jumps(angles.again)};
}

MotionCurves over_first(const MotionCurves& curves) {
  return {curves.ours / curves.ours[0], curves.papers / curves.papers[0], curves.solved / curves.solved[0],
          curves.again / curves.again[0]};
}

double last_of(const MotionCurve& curve) { return curve[curve.size() - 1]; }

MotionCurve constant_unit(const MotionCurves& curves, double unit) {
  return MotionCurve::Constant(curves.solved.size(), unit);
}

void append(TableCells& cells, const TableCells& more) { cells.insert(cells.end(), more.begin(), more.end()); }

ReportTable table_of(const std::string& name, const std::string& title, TableCells columns,
                     const std::vector<MotionQuantity>& quantities) {
  ReportTable table{name, title};
  table.columns = std::move(columns);
  for (const MotionQuantity& quantity : quantities) append(table.columns, columns_of(quantity));
  append(table.columns, cost_columns);
  return table;
}

TableCells cells_of(const MotionCurves& curves, const MotionCurve& unit) {
  return {number_text(worst_difference(curves.ours, curves.solved, unit)),
          number_text(worst_difference(curves.papers, curves.solved, unit)),
          number_text(worst_difference(curves.again, curves.solved, unit)),
          number_text(last_of(curves.ours), 4),
          number_text(last_of(curves.papers), 4),
          number_text(last_of(curves.solved), 4)};
}

TableCells costs_of(const TurningFilms& films) {
  return {std::to_string(films.solved.vertices), number_text(films.ours.trials),
          number_text(films.papers.trials),      number_text(films.ours.step_ms),
          number_text(films.papers.step_ms),     number_text(films.solved.error_estimate)};
}

}  // namespace supple
