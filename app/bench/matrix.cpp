#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "base/error.h"

namespace supple {
namespace {

constexpr int film_frames = 66;  // of which the renewals are counted
const std::vector<int> sampled_frames = {18, 30, 42, 54, 65};
constexpr int most_iterations = 60;
constexpr double tolerances[] = {1e-4, 1e-6};

}  // namespace

// Medians, of examinations and of renewals each for itself: what else the machine did in a frame does not count.
Renewals count_renewals(Subject& subject, Threads& threads, SystemMatrix matrix, const std::vector<int>& frames) {
  Renewals result;
  std::vector<double> renewing, examining;
  DrivenBody driver(subject.scene, subject.body, subject.model, subject.set,
                    solver_instead(Method::quasi_newton, 10, matrix), &threads);
  for (int frame = 0; frame < film_frames; ++frame) {
    if (std::binary_search(frames.begin(), frames.end(), frame)) {
      driver.prepare_step(frame, 0);
      result.states.push_back({frame, driver.state(), state_hash(subject.model, driver.state())});
    }
    const StepReport& last = driver.make_frame(frame, [&](const StepReport& report) {
      const bool first = renewing.empty() && examining.empty();  // made as a body is prepared, like A
      (driver.workspace().renewed && !first ? renewing : examining).push_back(report.matrix_ms);
    });
    if (last.failed) throw RunError(fmt::format("{}: frame {} failed", subject.choice.scene, frame));
  }
  const auto sum_of_medians = [](std::vector<double> ms) {
    if (ms.empty()) return 0.0;
    std::sort(ms.begin(), ms.end());
    return static_cast<double>(ms.size()) * ms[ms.size() / 2];
  };
  result.a_frame = static_cast<double>(renewing.size()) / film_frames;
  result.ms = (sum_of_medians(renewing) + sum_of_medians(examining)) / film_frames;
  return result;
}

namespace {

// Collects what one matrix achieved on a body's states.
struct Score {
  double log_error = 0, trials = 0, iterations = 0;
  double log_ms[std::size(tolerances)] = {};  // without renewals
  bool missed[std::size(tolerances)] = {};    // some state was not solved to it
};

// Compares the estimates with the errors, as factors.
struct Estimates {
  std::vector<double> ratios = {};
};

void add(Score& score, const Outcome& whole_run, const Outcome& ten, double lowest, const Renewals& renewals) {
  const std::vector<double> errors = errors_of(ten, lowest);
  score.log_error += std::log(std::max(errors.back(), 1e-15));
  score.trials += ten.trials;
  score.iterations += ten.iterations;
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    const double ms = time_to(whole_run, lowest, tolerances[t]);
    score.missed[t] |= !std::isfinite(ms);
    score.log_ms[t] += std::log((std::isfinite(ms) ? ms : whole_run.ms.back()) + renewals.ms);
  }
}

// Where the step itself made a matrix, its time is in the times of that state already, and all others are as if none
// were ever made; so it is taken out, and each state gets the film's average in its place.
void take_out_renewal(Outcome& outcome) {
  for (double& ms : outcome.ms) ms -= outcome.matrix_ms;
}

struct Means {
  double error = 0, to[std::size(tolerances)] = {};
  int bodies = 0;
};

// Holds a matrix that is compared with the constant one, and what it achieved in scenes without and with colliders.
struct Candidate {
  SystemMatrix matrix;
  ReportTable tables[2];
  Means means[2];
  Estimates estimates = {};
};

Candidate candidate_of(SystemMatrix matrix) {
  const std::string name(name_of(matrix));
  Candidate candidate{matrix,
                      {{"matrix-" + name, "Scenes without colliders: " + name},
                       {"matrix-" + name + "-colliders", "Scenes with colliders: " + name}},
                      {}};
  for (ReportTable& table : candidate.tables)
    table.columns = {"scene",
                     "body",
                     "vertices",
                     "error after 10, constant",
                     "error after 10, " + name,
                     "times nearer",
                     "trials an iteration, constant",
                     "trials an iteration, " + name,
                     "to 1e-4, constant [ms]",
                     "to 1e-4, " + name + " [ms]",
                     "to 1e-4, ratio",
                     "to 1e-6, constant [ms]",
                     "to 1e-6, " + name + " [ms]",
                     "to 1e-6, ratio",
                     "renewals a frame",
                     "their time a frame [ms]"};
  return candidate;
}

void add_row(Candidate& candidate, const Subject& subject, const Score (&scores)[2], const Renewals& renewals,
             double n) {
  const int group = subject.set.colliders.empty() ? 0 : 1;
  Means& means = candidate.means[group];
  const auto mean = [n](double sum) { return std::exp(sum / n); };
  const auto text = [&](const Score& s, std::size_t t) {
    return number_text(mean(s.log_ms[t])) + (s.missed[t] ? " (not all)" : "");
  };
  std::vector<std::string> row = {subject.choice.scene,
                                  subject.choice.body,
                                  std::to_string(subject.model.vertices),
                                  number_text(mean(scores[0].log_error)),
                                  number_text(mean(scores[1].log_error)),
                                  number_text(mean(scores[0].log_error - scores[1].log_error)),
                                  number_text(scores[0].trials / scores[0].iterations),
                                  number_text(scores[1].trials / scores[1].iterations)};
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    row.push_back(text(scores[0], t));
    row.push_back(text(scores[1], t));
    row.push_back(number_text(mean(scores[1].log_ms[t] - scores[0].log_ms[t])));
    means.to[t] += (scores[1].log_ms[t] - scores[0].log_ms[t]) / n;
  }
  means.error += (scores[0].log_error - scores[1].log_error) / n;
  ++means.bodies;
  row.push_back(number_text(renewals.a_frame));
  row.push_back(number_text(renewals.ms));
  candidate.tables[group].rows.push_back(std::move(row));
}

std::string text_of(const Means& means) {
  const double n = means.bodies;
  return fmt::format(
      "the error after ten iterations is {:.1f} times smaller, the time to 1e-4 {:.2f} and to 1e-6 {:.2f} "
      "times that of the constant matrix (geometric means over {} bodies)",
      std::exp(means.error / n), std::exp(means.to[0] / n), std::exp(means.to[1] / n), means.bodies);
}

std::string text_of(const Estimates& estimates, std::string_view label) {
  double within = 0, too_small = 0;
  for (const double ratio : estimates.ratios) {
    within += ratio >= 1.0 / 3 && ratio <= 3;
    too_small += ratio < 0.1;
  }
  const auto n = static_cast<double>(estimates.ratios.size());
  return fmt::format("{}: within a factor of 3 on {:.0f} % of {} states, more than ten times too small on {:.0f} %",
                     label, 100 * within / n, estimates.ratios.size(), 100 * too_small / n);
}

// Compares on states of the candidate's own film, which say how old its matrix is.
void compare(Candidate& candidate, Subject& subject, Estimates& of_constant, const BenchSetting& setting) {
  const Renewals renewals = count_renewals(subject, *setting.threads, candidate.matrix, sampled_frames);
  SolverComparison comparison(subject, *setting.threads);
  Score scores[2];
  int states = 0;
  for (const BenchState& state : renewals.states) {
    std::vector<SolverEntry> entries = {{"constant", Method::quasi_newton, most_iterations},
                                        {"constant, ten", Method::quasi_newton, 10},
                                        {"candidate", Method::quasi_newton, most_iterations},
                                        {"candidate, ten", Method::quasi_newton, 10}};
    entries[2].matrix = entries[3].matrix = candidate.matrix;
    std::vector<Outcome> outcomes = comparison.run(state, entries, 3, 1000);
    const Minimum lowest = comparison.reference(state, outcomes);
    const double scale = subject.model.total_mass * std::pow(subject.model.size / subject.model.time_step, 2);
    if (!(lowest.below_y > 1e-12 * scale)) continue;  // at rest: nothing to solve
    ++states;
    for (int m = 0; m < 2; ++m) {
      take_out_renewal(outcomes[2 * m]);
      add(scores[m], outcomes[2 * m], outcomes[2 * m + 1], lowest.below_y, m == 1 ? renewals : Renewals{});
      const double error = last_error(outcomes[2 * m + 1], lowest.below_y);
      if (error > 1e-13)
        (m == 0 ? of_constant : candidate.estimates).ratios.push_back(outcomes[2 * m + 1].error_estimate / error);
    }
  }
  if (states > 0) add_row(candidate, subject, scores, renewals, states);
}

}  // namespace

ReportSection bench_matrix(const BenchSetting& setting) {
  Candidate candidates[] = {candidate_of(SystemMatrix::tangent), candidate_of(SystemMatrix::hessian)};
  Estimates of_constant;
  for (const SubjectChoice& choice : all_subjects()) {
    Subject subject(choice);
    if (subject.model.vertices > most_vertices || subject.body.def.solver.method != Method::quasi_newton) continue;
    say_doing(setting, fmt::format("{}, {} ({})", choice.scene, choice.body, subject.size_text()));
    for (Candidate& candidate : candidates) compare(candidate, subject, of_constant, setting);
  }
  ReportSection section{"matrix", "Matrices that follow the body"};
  section.text = fmt::format(
      "Matrices that follow the body beside the constant one, M/h^2 + L, on states of all bodies of up to {} vertices, "
      "geometric means over their frames. Times contain the renewals that the matrix' film had, on average over {} "
      "frames.",
      most_vertices, film_frames);
  for (const Candidate& candidate : candidates)
    section.text += fmt::format(" {}, without colliders: {}; with colliders: {}.", name_of(candidate.matrix),
                                text_of(candidate.means[0]), text_of(candidate.means[1]));
  section.text += " Estimates of the error after ten iterations, " + text_of(of_constant, "constant");
  for (const Candidate& candidate : candidates)
    section.text += "; " + text_of(candidate.estimates, name_of(candidate.matrix));
  section.text += ".";
  for (Candidate& candidate : candidates) {
    for (ReportTable& table : candidate.tables) section.tables.push_back(std::move(table));
  }
  return section;
}

}  // namespace supple
