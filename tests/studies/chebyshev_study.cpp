// Finds which delay and radius make Chebyshev's method best at ten iterations a step. Every scene that ships is played
// with its own settings; from stored states one step is made with each pair, and its error (equation 12) is set against
// that of Projective Dynamics, which is the same method without acceleration. Prints markdown.
//   supple_chebyshev_study STATES [MOST_VERTICES]      (STATES: a folder that keeps the states for the next run)
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/bench/subject.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"

using namespace supple;

namespace {

constexpr int iterations = 10;
const std::vector<int> frames = {12, 30, 54};

struct Candidate {
  std::string name;
  Method method;
  ChebyshevSettings chebyshev = {};
  std::vector<double> error = {};  // by state; NaN: the step failed
};

// The first candidate is Projective Dynamics, the second the paper's method.
std::vector<Candidate> candidates() {
  std::vector<Candidate> list = {{"projective-dynamics", Method::projective_dynamics},
                                 {"quasi-newton", Method::quasi_newton}};
  for (const int delay : {0, 1, 2, 3, 4, 5, 6, 7, 8}) {
    for (const double radius : {0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.99})
      list.push_back({fmt::format("delay {}, radius {:g}", delay, radius), Method::chebyshev, {delay, radius}});
  }
  return list;
}

struct StudiedState {
  std::string scene;
  std::string body;
  int frame;
};

// Adds the errors of all candidates on one state, or nothing where the body is at rest.
bool add_state(Subject& subject, const BenchState& state, std::vector<Candidate>& list,
               std::vector<std::unique_ptr<SearchRule>>& rules, Reference& reference, OpenWorkspace& workspace) {
  StepInputs inputs = subject.inputs(state);
  inputs.solver.iterations = iterations;
  inputs.solver.history = SolverSettings{}.history;
  inputs.solver.line_search = LineSearch::armijo;
  std::vector<double> gain(list.size(), std::nan(""));
  double most = -1;
  Positions best = state.before.x;
  for (std::size_t c = 0; c < list.size(); ++c) {
    StepInputs own = inputs;
    own.solver.chebyshev = list[c].chebyshev;
    own.solver = settings_of(list[c].method, own.solver);
    State after = state.before;
    workspace.correction = {};  // each candidate finds the columns of A^-1 that it needs itself
    if (step(subject.model(), own, after, workspace, *rules[c]).failed) continue;
    gain[c] = gained(subject.model(), inputs, state.before, after.x, workspace);
    if (gain[c] > most) {
      most = gain[c];
      best = after.x;
    }
  }
  const double whole = reference.minimum(subject.model(), inputs, state.before, best, workspace).below_y;
  const double scale = subject.model().total_mass * std::pow(subject.model().size / subject.model().time_step, 2);
  if (!(whole > 1e-12 * scale)) return false;
  for (std::size_t c = 0; c < list.size(); ++c) list[c].error.push_back(std::max((whole - gain[c]) / whole, 1e-15));
  return true;
}

struct Score {
  double ratio = 0;  // geometric mean of the error over Projective Dynamics'
  double worst = 0;  // largest such ratio
  double mean = 0;   // arithmetic mean of the error
  int better = 0;    // states with a smaller error than Projective Dynamics
  int failed = 0;
};

// Returns the score over the states with these indices.
Score score_of(const Candidate& candidate, const Candidate& plain, const std::vector<std::size_t>& states) {
  Score score;
  for (const std::size_t s : states) {
    if (std::isnan(candidate.error[s])) {
      ++score.failed;
      continue;
    }
    const double ratio = candidate.error[s] / plain.error[s];
    score.ratio += std::log(ratio);
    score.worst = std::max(score.worst, ratio);
    score.mean += candidate.error[s];
    score.better += ratio < 1;
  }
  const double count = static_cast<double>(states.size()) - score.failed;
  score.ratio = std::exp(score.ratio / count);
  score.mean /= count;
  return score;
}

void print_scores(const std::string& title, std::vector<Candidate> list, const std::vector<std::size_t>& states) {
  const Candidate plain = list.front();
  std::sort(list.begin() + 2, list.end(), [&](const Candidate& a, const Candidate& b) {
    return score_of(a, plain, states).ratio < score_of(b, plain, states).ratio;
  });
  fmt::print(
      "\n{}: {} states\n\n| method | error over PD's, geometric mean | worst | better in | mean error | failed |\n"
      "|---|---|---|---|---|---|\n",
      title, states.size());
  for (const Candidate& candidate : list) {
    const Score score = score_of(candidate, plain, states);
    fmt::print("| {} | {:.3f} | {:.2f} | {} | {:.2e} | {} |\n", candidate.name, score.ratio, score.worst, score.better,
               score.mean, score.failed);
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const int most_vertices = count > 2 ? std::atoi(arguments[2]) : 3000;
  std::vector<Candidate> list = candidates();
  std::vector<StudiedState> states;
  Threads threads(2);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / "scenes")) files.push_back(entry);
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    for (const BodyDef& def : load_scene(file, assets_folder(), {}).bodies) {
      Subject subject({file.stem().string(), def.name});
      if (subject.model().vertices > most_vertices) continue;
      fmt::print(stderr, "{}, {} ({})\n", subject.scene().name, def.name, subject.size_text());
      std::vector<std::unique_ptr<SearchRule>> rules;
      for (const Candidate& candidate : list) rules.push_back(make_rule(candidate.method, subject.model()));
      Reference reference(subject.model());
      OpenWorkspace workspace;
      workspace.threads = &threads;
      for (const BenchState& state : states_of(subject, frames, arguments[1], threads)) {
        if (add_state(subject, state, list, rules, reference, workspace))
          states.push_back({subject.scene().name, def.name, state.frame});
      }
    }
  }
  std::vector<std::size_t> all, train, check;
  for (std::size_t s = 0; s < states.size(); ++s) {
    all.push_back(s);
    (states[s].frame == frames.back() ? check : train).push_back(s);
  }
  print_scores("All", list, all);
  print_scores(fmt::format("Frames {} and {}", frames[0], frames[1]), list, train);
  print_scores(fmt::format("Frame {}", frames[2]), list, check);
  const Candidate& plain = list[0];
  const auto best = std::min_element(list.begin() + 2, list.end(), [&](const Candidate& a, const Candidate& b) {
    return score_of(a, plain, all).ratio < score_of(b, plain, all).ratio;
  });
  fmt::print("\n| scene | body | frame | projective-dynamics | {} | quasi-newton |\n|---|---|---|---|---|---|\n",
             best->name);
  for (std::size_t s = 0; s < states.size(); ++s) {
    fmt::print("| {} | {} | {} | {:.2e} | {:.2e} | {:.2e} |\n", states[s].scene, states[s].body, states[s].frame,
               plain.error[s], best->error[s], list[1].error[s]);
  }
  return 0;
}
