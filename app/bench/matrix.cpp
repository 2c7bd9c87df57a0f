#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/bench/sections.h"
#include "base/error.h"

namespace supple {
namespace {

constexpr int film_frames = 66;  // frames of a film in which renewals are counted
const std::vector<int> sampled_frames = {18, 30, 42, 54, 65};
constexpr int most_iterations = 60;
constexpr double tolerances[] = {1e-4, 1e-6};
constexpr double motion_tolerances[] = {1e-2, 1e-3};
constexpr int motion_iterations[] = {3, 5, 10};  // iterations after which errors of motion are compared

}  // namespace

// Counts each renewal, and each examination of whether one is due, with the median of its kind, so that other work of
// the machine in some frame does not count.
PlayedFilm play_film(Subject& subject, Threads& threads, DirectionStart start, const std::vector<int>& frames) {
  PlayedFilm film;
  std::vector<double> renewing, examining;
  World world = subject.new_world(solver_instead(Method::quasi_newton, 10, start), threads);
  MovingBody& body = world.body(0);
  for (int frame = 0; frame < film_frames; ++frame) {
    world.enter(frame);
    if (std::binary_search(frames.begin(), frames.end(), frame)) {
      world.prepare(0);
      film.states.push_back({frame, body.state(), state_hash(body.model(), body.state())});
    }
    const bool made =
        world.step({{}, [&](std::size_t, int) {
                      // The first matrix is made as a body is prepared, and does not count as a renewal.
                      const bool first = renewing.empty() && examining.empty();
                      (body.workspace().renewed && !first ? renewing : examining).push_back(body.report().matrix_ms);
                    }});
    if (!made) throw RunError(fmt::format("{}: frame {} failed", subject.choice.scene, frame));
  }
  const auto sum_of_medians = [](std::vector<double> ms) {
    if (ms.empty()) return 0.0;
    std::sort(ms.begin(), ms.end());
    return static_cast<double>(ms.size()) * ms[ms.size() / 2];
  };
  film.renewals = static_cast<double>(renewing.size()) / film_frames;
  if (start.matrix != StartMatrix::system)
    film.renewal_ms = (sum_of_medians(renewing) + sum_of_medians(examining)) / film_frames;
  return film;
}

namespace {

// Collects what one start of directions achieved on a body's states.
struct Score {
  double log_error[2] = {};  // after five iterations and after ten
  double trials = 0, iterations = 0;
  double log_iterations[std::size(tolerances)] = {};        // to each tolerance
  double log_ms[std::size(tolerances)] = {};                // time to each tolerance, with the film's mean of renewals
  bool missed[std::size(tolerances)] = {};                  // whether some state was not solved to it
  double log_motion[std::size(motion_iterations)] = {};     // errors of motion
  double log_motion_ms[std::size(motion_tolerances)] = {};  // time to each tolerance of the error of motion
  bool missed_motion[std::size(motion_tolerances)] = {};    // whether some state was not solved to it
};

void add(Score& score, const Outcome& whole_run, const Outcome& ten, double lowest, double renewal_ms) {
  const std::vector<double> errors = errors_of(ten, lowest), all_errors = errors_of(whole_run, lowest);
  const auto logarithm = [](double error) { return std::log(std::max(error, 1e-15)); };
  score.log_error[0] += logarithm(errors[std::min<std::size_t>(5, errors.size() - 1)]);
  score.log_error[1] += logarithm(errors.back());
  score.trials += ten.trials;
  score.iterations += ten.iterations;
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    const double ms = time_to(whole_run, lowest, tolerances[t]);
    score.missed[t] |= !std::isfinite(ms);
    score.log_ms[t] += std::log((std::isfinite(ms) ? ms : whole_run.ms.back()) + renewal_ms);
    const auto near = [&](double error) { return error <= tolerances[t]; };
    const auto place = std::find_if(all_errors.begin(), all_errors.end(), near) - all_errors.begin();
    score.log_iterations[t] += std::log(1.0 + static_cast<double>(place));
  }
}

// Adds the errors of motion of a state to a score. estimates: the list to which the estimate of the error of motion
// after ten iterations, over the error, is added.
void add_motion(Score& score, const Outcome& whole_run, const Outcome& ten, const std::vector<double>& errors,
                std::vector<double>& estimates) {
  const auto after = [&](int iterations) {
    return std::max(errors[std::min<std::size_t>(iterations, errors.size() - 1)], 1e-12);
  };
  for (std::size_t i = 0; i < std::size(motion_iterations); ++i)
    score.log_motion[i] += std::log(after(motion_iterations[i]));
  if (after(10) > 1e-8) estimates.push_back(ten.motion_estimate / after(10));
  for (std::size_t t = 0; t < std::size(motion_tolerances); ++t) {
    const double ms = time_to(whole_run, errors, motion_tolerances[t]);
    score.missed_motion[t] |= !std::isfinite(ms);
    score.log_motion_ms[t] += std::log(std::isfinite(ms) ? ms : whole_run.ms.back());
  }
}

// Takes the time of making a matrix out of a state's times. Only few steps make one, so the states of these steps would
// seem slower than the others. The film's average of this time is added to all states instead.
void take_out_renewal(Outcome& outcome) {
  for (double& ms : outcome.ms) ms -= outcome.matrix_ms;
}

// Holds estimates after ten iterations over the true errors, by state.
struct Estimates {
  std::vector<double> error = {}, motion = {};
};

struct Means {
  double nearer[2] = {}, ms[std::size(tolerances)] = {}, iterations[std::size(tolerances)] = {};
  double motion_nearer[std::size(motion_iterations)] = {}, motion_ms[std::size(motion_tolerances)] = {};
  int bodies = 0;
};

// Holds a start of directions that is compared with the paper's, and what it achieved in scenes without and with
// colliders.
struct Candidate {
  DirectionStart start;
  ReportTable tables[2];
  Means means[2] = {};
  Estimates estimates = {};
};

Candidate candidate_of(DirectionStart start) {
  const std::string text = text_of(start);
  const std::string name = std::string(name_of(start.matrix)) + (start.second_level ? "-two-levels" : "");
  Candidate candidate{start,
                      {{"matrix-" + name, "Scenes without colliders: " + text},
                       {"matrix-" + name + "-colliders", "Scenes with colliders: " + text}}};
  for (ReportTable& table : candidate.tables)
    table.columns = {"scene",
                     "body",
                     "vertices",
                     "error after 5, paper's",
                     "error after 5",
                     "error after 10, paper's",
                     "error after 10",
                     "times nearer",
                     "motion error after 3, paper's",
                     "motion error after 3",
                     "after 5, paper's",
                     "after 5",
                     "after 10, paper's",
                     "after 10",
                     "to motion error 1e-2, ratio of times",
                     "to 1e-3, ratio of times",
                     "trials an iteration, paper's",
                     "trials an iteration",
                     "iterations to 1e-4, ratio",
                     "to 1e-4, paper's [ms]",
                     "to 1e-4 [ms]",
                     "to 1e-4, ratio",
                     "iterations to 1e-6, ratio",
                     "to 1e-6, paper's [ms]",
                     "to 1e-6 [ms]",
                     "to 1e-6, ratio",
                     "renewals a frame",
                     "their time a frame [ms]"};
  return candidate;
}

void add_row(Candidate& candidate, const Subject& subject, const Score& papers, const Score& score,
             const PlayedFilm& film, double n) {
  const int group = subject.world.colliders().colliders.empty() ? 0 : 1;
  Means& means = candidate.means[group];
  const auto mean = [n](double sum) { return number_text(std::exp(sum / n)); };
  const auto text = [&](const Score& s, std::size_t t) {
    return mean(s.log_ms[t]) + (s.missed[t] ? " (not all)" : "");
  };
  std::vector<std::string> row = {subject.choice.scene, subject.choice.body, std::to_string(subject.model().vertices)};
  for (int i = 0; i < 2; ++i) {
    row.push_back(mean(papers.log_error[i]));
    row.push_back(mean(score.log_error[i]));
    means.nearer[i] += (papers.log_error[i] - score.log_error[i]) / n;
  }
  row.push_back(mean(papers.log_error[1] - score.log_error[1]));
  for (std::size_t i = 0; i < std::size(motion_iterations); ++i) {
    means.motion_nearer[i] += (papers.log_motion[i] - score.log_motion[i]) / n;
    row.push_back(mean(papers.log_motion[i]));
    row.push_back(mean(score.log_motion[i]));
  }
  for (std::size_t t = 0; t < std::size(motion_tolerances); ++t) {
    means.motion_ms[t] += (score.log_motion_ms[t] - papers.log_motion_ms[t]) / n;
    row.push_back(mean(score.log_motion_ms[t] - papers.log_motion_ms[t]) +
                  (score.missed_motion[t] ? " (not all)" : ""));
  }
  row.push_back(number_text(papers.trials / papers.iterations));
  row.push_back(number_text(score.trials / score.iterations));
  for (std::size_t t = 0; t < std::size(tolerances); ++t) {
    row.push_back(mean(score.log_iterations[t] - papers.log_iterations[t]));
    row.push_back(text(papers, t));
    row.push_back(text(score, t));
    row.push_back(mean(score.log_ms[t] - papers.log_ms[t]));
    means.ms[t] += (score.log_ms[t] - papers.log_ms[t]) / n;
    means.iterations[t] += (score.log_iterations[t] - papers.log_iterations[t]) / n;
  }
  ++means.bodies;
  for (const double number : {film.renewals, film.renewal_ms}) row.push_back(number_text(number));
  candidate.tables[group].rows.push_back(std::move(row));
}

std::string text_of(const Means& means) {
  const double n = means.bodies;
  return fmt::format(
      "the error is {:.1f} times smaller after five iterations and {:.1f} times after ten; iterations to 1e-4 and 1e-6 "
      "are {:.2f} and {:.2f}, times {:.2f} and {:.2f} of the paper's; the error of motion is {:.1f}, {:.1f} and {:.1f} "
      "times smaller after three, five and ten iterations, and times to 1e-2 and 1e-3 of it are {:.2f} and {:.2f} "
      "(geometric means over {} bodies)",
      std::exp(means.nearer[0] / n), std::exp(means.nearer[1] / n), std::exp(means.iterations[0] / n),
      std::exp(means.iterations[1] / n), std::exp(means.ms[0] / n), std::exp(means.ms[1] / n),
      std::exp(means.motion_nearer[0] / n), std::exp(means.motion_nearer[1] / n), std::exp(means.motion_nearer[2] / n),
      std::exp(means.motion_ms[0] / n), std::exp(means.motion_ms[1] / n), means.bodies);
}

std::string text_of_ratios(const std::vector<double>& ratios) {
  const auto percent = [&](const auto& rule) {
    const auto count = static_cast<double>(std::count_if(ratios.begin(), ratios.end(), rule));
    return ratios.empty() ? 0 : 100 * count / static_cast<double>(ratios.size());
  };
  return fmt::format("within a factor of 3 on {:.0f} % of {} states, more than ten times too small on {:.0f} %",
                     percent([](double ratio) { return ratio >= 1.0 / 3 && ratio <= 3; }), ratios.size(),
                     percent([](double ratio) { return ratio < 0.1; }));
}

std::string text_of_estimates(const Estimates& estimates, const std::string& label) {
  return fmt::format("{}: of equation 12 {}, of the error of motion {}", label, text_of_ratios(estimates.error),
                     text_of_ratios(estimates.motion));
}

// Compares a candidate with the paper's start of directions, on states of the candidate's own film: their frames say
// how old its matrix is.
void compare(Candidate& candidate, Subject& subject, Estimates& papers_estimates, const BenchSetting& setting) {
  const PlayedFilm film = play_film(subject, *setting.threads, candidate.start, sampled_frames);
  SolverComparison comparison(subject, *setting.threads);
  Score papers, score;
  int states = 0;
  for (const BenchState& state : film.states) {
    std::vector<SolverEntry> entries = {{"paper's", Method::quasi_newton, most_iterations},
                                        {"paper's, ten", Method::quasi_newton, 10},
                                        {"candidate", Method::quasi_newton, most_iterations},
                                        {"candidate, ten", Method::quasi_newton, 10}};
    entries[2].start = entries[3].start = candidate.start;
    std::vector<Outcome> outcomes = comparison.run(state, entries, 3, 1000);
    const Minimum lowest = comparison.reference(state, outcomes);
    const double scale = subject.model().total_mass * std::pow(subject.model().size / subject.model().time_step, 2);
    if (!(lowest.below_y > 1e-12 * scale)) continue;  // at rest: nothing to solve
    ++states;
    if (candidate.start.matrix != StartMatrix::system) take_out_renewal(outcomes[2]);
    add_motion(papers, outcomes[0], outcomes[1], comparison.motion_errors(state, outcomes[0], lowest.x),
               papers_estimates.motion);
    add_motion(score, outcomes[2], outcomes[3], comparison.motion_errors(state, outcomes[2], lowest.x),
               candidate.estimates.motion);
    add(papers, outcomes[0], outcomes[1], lowest.below_y, 0);
    add(score, outcomes[2], outcomes[3], lowest.below_y, film.renewal_ms);
    for (const int ten : {1, 3}) {
      const double error = last_error(outcomes[ten], lowest.below_y);
      if (error > 1e-13)
        (ten == 1 ? papers_estimates : candidate.estimates).error.push_back(outcomes[ten].error_estimate / error);
    }
  }
  if (states > 0) add_row(candidate, subject, papers, score, film, states);
}

}  // namespace

ReportSection bench_matrix(const BenchSetting& setting) {
  Candidate candidates[] = {candidate_of({StartMatrix::system, true}), candidate_of({StartMatrix::tangent}),
                            candidate_of({StartMatrix::turned_hessian})};
  Estimates papers_estimates;
  for (const SubjectChoice& choice : all_subjects()) {
    Subject subject(choice);
    if (subject.model().vertices > most_vertices || subject.body().def.solver.method != Method::quasi_newton) continue;
    say_doing(setting, fmt::format("{}, {} ({})", choice.scene, choice.body, subject.size_text()));
    for (Candidate& candidate : candidates) compare(candidate, subject, papers_estimates, setting);
  }
  ReportSection section{"matrix", "What directions start from"};
  section.text = fmt::format(
      "Two levels, solver.levels, and matrices that follow the body, solver.matrix, beside the paper's "
      "matrix, M/h^2 + L, on states of all bodies of up to {} vertices, geometric means over their frames. Times "
      "contain the renewals that the matrix' film had, on "
      "average over {} frames.",
      most_vertices, film_frames);
  for (const Candidate& candidate : candidates)
    section.text += fmt::format(" {}, without colliders: {}; with colliders: {}.", text_of(candidate.start),
                                text_of(candidate.means[0]), text_of(candidate.means[1]));
  section.text += " Estimates after ten iterations: " + text_of_estimates(papers_estimates, "the paper's");
  for (const Candidate& candidate : candidates)
    section.text += "; " + text_of_estimates(candidate.estimates, text_of(candidate.start));
  section.text += ".";
  for (Candidate& candidate : candidates) {
    for (ReportTable& table : candidate.tables) section.tables.push_back(std::move(table));
  }
  return section;
}

}  // namespace supple
