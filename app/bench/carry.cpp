#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "base/error.h"

namespace supple {
namespace {

constexpr int film_frames = 66;
const std::vector<int> sampled_frames = {18, 30, 42, 54, 65};
constexpr int most_iterations = 40;
constexpr double tolerances[] = {1e-4, 1e-6};

// Holds what was counted in a film in which each step begins with the pair of the one before, by solver.carry.
struct CarryingFilm {
  std::vector<BenchState> states;
  int steps = 0, used = 0, misled = 0;
};

CarryingFilm film_of(Subject& subject, Threads& threads, SystemMatrix matrix) {
  Solvers solvers = solver_instead(Method::quasi_newton, 10, matrix);
  solvers.settings = [usual = solvers.settings](const SolverDef& solver) {
    SolverSettings settings = usual(solver);
    settings.carry = true;
    return settings;
  };
  CarryingFilm film;
  DrivenBody driver(subject.scene, subject.body, subject.model, subject.set, solvers, &threads);
  for (int frame = 0; frame < film_frames; ++frame) {
    if (std::binary_search(sampled_frames.begin(), sampled_frames.end(), frame)) {
      driver.prepare_step(frame, 0);
      film.states.push_back({frame, driver.state(), state_hash(subject.model, driver.state())});
    }
    const StepReport& last = driver.make_frame(frame, [&](const StepReport&) {
      const CarryingWork& carrying = driver.workspace().carrying;
      ++film.steps;
      film.used += carrying.used;
      film.misled += carrying.used && carrying.misled;
    });
    if (last.failed) throw RunError(fmt::format("{}: frame {} failed", subject.choice.scene, frame));
  }
  return film;
}

// Holds sums over a body's states, of a solver without the pair and of one with it.
struct Score {
  double log_five = 0, log_ten = 0, trials = 0, iterations = 0;
  double log_ms[std::size(tolerances)] = {}, log_iterations[std::size(tolerances)] = {};
};

void add(Score& score, const Outcome& outcome, double lowest) {
  const std::vector<double> errors = errors_of(outcome, lowest);
  const auto error_after = [&](std::size_t k) {
    return std::log(std::max(errors[std::min(k, errors.size() - 1)], 1e-15));
  };
  score.log_five += error_after(5);
  score.log_ten += error_after(10);
  score.trials += outcome.trials;
  score.iterations += outcome.iterations;
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    const double ms = time_to(outcome, lowest, tolerances[t]);
    score.log_ms[t] += std::log((std::isfinite(ms) ? ms : outcome.ms.back()) - outcome.matrix_ms);
    const auto near = [&](double error) { return error <= tolerances[t]; };
    score.log_iterations[t] +=
        std::log(1.0 + static_cast<double>(std::find_if(errors.begin(), errors.end(), near) - errors.begin()));
  }
}

struct Means {
  double five = 0, ten = 0, ms[std::size(tolerances)] = {}, iterations[std::size(tolerances)] = {};
  int bodies = 0;
};

struct Comparison {
  SystemMatrix matrix;
  ReportTable tables[2];  // without and with colliders
  Means means[2] = {};
};

Comparison comparison_of(SystemMatrix matrix) {
  const std::string name(name_of(matrix));
  Comparison comparison{matrix,
                        {{"carry-" + name, "Scenes without colliders: " + name},
                         {"carry-" + name + "-colliders", "Scenes with colliders: " + name}}};
  for (ReportTable& table : comparison.tables)
    table.columns = {"scene",
                     "body",
                     "vertices",
                     "error after 5",
                     "error after 5, carried",
                     "error after 10",
                     "error after 10, carried",
                     "times nearer",
                     "trials an iteration",
                     "trials an iteration, carried",
                     "iterations to 1e-4, ratio",
                     "to 1e-4 [ms]",
                     "to 1e-4, ratio",
                     "to 1e-6 [ms]",
                     "to 1e-6, ratio",
                     "steps that began with the pair",
                     "of these, misled"};
  return comparison;
}

void add_row(Comparison& comparison, const Subject& subject, const Score& without, const Score& with,
             const CarryingFilm& film, double n) {
  const int group = subject.set.colliders.empty() ? 0 : 1;
  Means& means = comparison.means[group];
  const auto mean = [n](double sum) { return number_text(std::exp(sum / n)); };
  std::vector<std::string> row = {subject.choice.scene,
                                  subject.choice.body,
                                  std::to_string(subject.model.vertices),
                                  mean(without.log_five),
                                  mean(with.log_five),
                                  mean(without.log_ten),
                                  mean(with.log_ten),
                                  mean(without.log_ten - with.log_ten),
                                  number_text(without.trials / without.iterations),
                                  number_text(with.trials / with.iterations),
                                  mean(with.log_iterations[0] - without.log_iterations[0])};
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    row.push_back(mean(without.log_ms[t]));
    row.push_back(mean(with.log_ms[t] - without.log_ms[t]));
    means.ms[t] += (with.log_ms[t] - without.log_ms[t]) / n;
    means.iterations[t] += (with.log_iterations[t] - without.log_iterations[t]) / n;
  }
  row.push_back(number_text(static_cast<double>(film.used) / film.steps));
  row.push_back(number_text(film.used == 0 ? 0 : static_cast<double>(film.misled) / film.used));
  means.five += (without.log_five - with.log_five) / n;
  means.ten += (without.log_ten - with.log_ten) / n;
  ++means.bodies;
  comparison.tables[group].rows.push_back(std::move(row));
}

std::string text_of(const Means& means) {
  const double n = means.bodies;
  return fmt::format(
      "the error is {:.1f} times smaller after five iterations and {:.1f} times after ten; iterations to 1e-4 and 1e-6 "
      "are {:.2f} and {:.2f}, times {:.2f} and {:.2f} of those without the pair (geometric means over {} bodies)",
      std::exp(means.five / n), std::exp(means.ten / n), std::exp(means.iterations[0] / n),
      std::exp(means.iterations[1] / n), std::exp(means.ms[0] / n), std::exp(means.ms[1] / n), means.bodies);
}

void compare(Comparison& comparison, Subject& subject, const BenchSetting& setting) {
  const CarryingFilm film = film_of(subject, *setting.threads, comparison.matrix);
  SolverComparison solvers(subject, *setting.threads);
  Score without, with;
  int states = 0;
  for (const BenchState& state : film.states) {
    std::vector<SolverEntry> entries = {{"without", Method::quasi_newton, most_iterations},
                                        {"carried", Method::quasi_newton, most_iterations}};
    entries[0].matrix = entries[1].matrix = comparison.matrix;
    entries[1].carry = true;
    const std::vector<Outcome> outcomes = solvers.run(state, entries, 3, 1000);
    const Minimum lowest = solvers.reference(state, outcomes);
    const double scale = subject.model.total_mass * std::pow(subject.model.size / subject.model.time_step, 2);
    if (!(lowest.below_y > 1e-12 * scale)) continue;  // at rest: nothing to solve
    ++states;
    add(without, outcomes[0], lowest.below_y);
    add(with, outcomes[1], lowest.below_y);
  }
  if (states > 0) add_row(comparison, subject, without, with, film, states);
}

}  // namespace

ReportSection bench_carry(const BenchSetting& setting) {
  Comparison comparisons[] = {comparison_of(SystemMatrix::constant), comparison_of(SystemMatrix::tangent),
                              comparison_of(SystemMatrix::hessian)};
  for (const SubjectChoice& choice : all_subjects()) {
    Subject subject(choice);
    if (subject.model.vertices > most_vertices || subject.body.def.solver.method != Method::quasi_newton) continue;
    say_doing(setting, fmt::format("{}, {} ({})", choice.scene, choice.body, subject.size_text()));
    for (Comparison& comparison : comparisons) compare(comparison, subject, setting);
  }
  ReportSection section{"carry", "A pair that is carried over"};
  section.text = fmt::format(
      "Steps that begin with the pair of the step before, solver.carry, beside the same without it, on states of the "
      "films that carry it, of all bodies of up to {} vertices. Making a matrix is not in the times.",
      most_vertices);
  for (Comparison& comparison : comparisons) {
    section.text += fmt::format(" {}, without colliders: {}; with colliders: {}.", name_of(comparison.matrix),
                                text_of(comparison.means[0]), text_of(comparison.means[1]));
    for (ReportTable& table : comparison.tables) section.tables.push_back(std::move(table));
  }
  return section;
}

}  // namespace supple
