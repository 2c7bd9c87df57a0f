// Reads the table `solver` of a scene or a body.
#include <algorithm>

#include "scene/reading/table_readers.h"

namespace supple {
namespace {

// These are words of earlier versions of the format for combinations of parts.
constexpr std::array former_method_names = {
    ShortName{"newton-shifted", Method::newton_shifted},
    ShortName{"newton-cg5", Method::newton_cg(5)},
    ShortName{"newton-cg15", Method::newton_cg(15)},
    ShortName{"quasi-newton-cg5", Method::quasi_newton_cg(5)},
    ShortName{"quasi-newton-cg15", Method::quasi_newton_cg(15)},
    ShortName{"lbfgs-identity", Method::lbfgs_from(StartMatrix::identity)},
    ShortName{"lbfgs-rest", Method::lbfgs_from(StartMatrix::rest_hessian)},
    ShortName{"lbfgs-warped", Method::lbfgs_from(StartMatrix::warped_rest_hessian)},
    ShortName{"lbfgs-frame", Method::lbfgs_from(StartMatrix::frame_hessian)},
    ShortName{"lbfgs-frame-cg5-rest", Method::frame_cg(5, Preconditioner::rest)},
    ShortName{"lbfgs-frame-cg15-rest", Method::frame_cg(15, Preconditioner::rest)},
    ShortName{"lbfgs-frame-cg5-ours", Method::frame_cg(5, Preconditioner::system)},
    ShortName{"lbfgs-frame-cg15-ours", Method::frame_cg(15, Preconditioner::system)},
};

Words method_words() {
  Words words;
  for (const ShortName& entry : short_names) words.allowed.emplace_back(entry.name);
  for (const ShortName& entry : former_method_names)
    words.former.push_back({std::string(entry.name), spelling_of(entry.method)});
  words.gone = {{"hecht", spelling_of(Method::lbfgs_from(StartMatrix::warped_rest_hessian))},
                {"contact-matrix", spelling_of(Method::quasi_newton)}};
  return words;
}

// Returns the words of `solver.matrix`, with those of earlier versions.
Words matrix_words() {
  Words words;
  for (const StartMatrix matrix : quasi_newton_matrices) words.allowed.emplace_back(name_of(matrix));
  words.former = {{"constant", "\"system\""}, {"hessian", "\"turned-hessian\""}};
  return words;
}

Method method_of_parts(const ConfigTable& table) {
  Method method;
  method.matrix = table.word<StartMatrix>(
      {"matrix", "", "what a search direction starts from"}, std::nullopt,
      {.allowed = method_matrices(), .gone = {{"hecht", "\"warped-rest-hessian\""}, {"contact", "\"system\""}}});
  method.linear = table.word<LinearSolver>(
      {"linear", "", "systems with it are solved by a factor, or by conjugate gradients"}, LinearSolver::direct);
  const MethodForm* form = form_of(method.matrix, method.linear);
  const int inner =
      table.integer({"inner_iterations", "", "of conjugate gradients, at most"}, 15, Range::between(1, 10000));
  method.inner_tolerance = table.number(
      {"inner_tolerance", "", "they also end once the residual is this share of the first; of matrix = \"hessian\""}, 0,
      Range::between(0, 0.999));
  const auto preconditioner = table.word_if_given<Preconditioner>(
      {"preconditioner", "",
       "of conjugate gradients: the diagonal, or an incomplete factor of the rest pose's Hessian or of the system"},
      "by the matrix");
  const auto acceleration = table.word_if_given<Acceleration>(
      {"acceleration", "", "what an iteration learns from earlier ones; the hessian goes without"}, "by the matrix");
  const auto safeguard = table.word_if_given<Safeguard>(
      {"safeguard", "", "of matrix = \"hessian\" where it is not positive definite"}, "by the matrix");
  const bool cg = method.linear == LinearSolver::cg;
  if (cg) method.inner_iterations = inner;
  if (!cg && table.has("inner_iterations"))
    table.complain("inner_iterations", "inner_iterations: only with linear = \"cg\"");
  if (form != nullptr) {
    method.preconditioner = preconditioner.value_or(form->preconditioner.usual());
    method.acceleration = acceleration.value_or(form->acceleration.usual());
    method.safeguard = safeguard.value_or(form->safeguard.usual());
  }
  const auto problem = problem_of(method);
  if (!problem || !table.has("matrix")) return method;
  table.complain(problem->part, problem->message);
  return Method::quasi_newton;
}

Method read_method(const ConfigTable& table, const Method& fallback) {
  const Key key = {"method", "",
                   "how a step is solved, by a word or by its parts; all but quasi-newton are for comparison"};
  const auto given = table.word_or_table(key, spelling_of(fallback), method_words());
  if (!given) return fallback;
  if (const auto* parts = std::get_if<ConfigTable>(&*given)) return method_of_parts(*parts);
  const auto named = [&](const ShortName& entry) { return entry.name == std::get<std::string>(*given); };
  return std::find_if(short_names.begin(), short_names.end(), named)->method;
}

ContactSettings read_contact(const ConfigTable& table, ContactSettings contact) {
  contact.stiffness = table.number({"stiffness", "", "k_c of a touching vertex, over m / h^2"}, contact.stiffness,
                                   Range::above(0, 1e8));
  contact.push_out =
      table.number({"push_out", "1/s", "fastest way out of a deep overlap, in the body's sizes a second"},
                   contact.push_out, Range::positive());
  contact.stick = table.number({"stick", "1/s", "slip above which friction is whole, in the body's sizes a second"},
                               contact.stick, Range::positive());
  contact.points = table.word<ContactPoints>({"points", "",
                                              "what of a body touches: its vertices, or also points of edges and faces "
                                              "where a collider is finer than the body's surface"},
                                             contact.points);
  contact.direction = table.word<ContactDirection>(
      {"direction", "", "how search directions know contacts: each by itself, or all together by a small system"},
      contact.direction, {.allowed = all_names<ContactDirection>(), .gone = {{"ignored", "\"low-rank\""}}});
  if (table.has("history"))
    table.complain("history", "history: exists no more; all pairs of L-BFGS have the contacts in force now");
  return contact;
}

SolverSettings read_settings(const ConfigTable& table, SolverSettings s) {
  s.iterations = table.integer(
      {"iterations", "",
       "quasi-Newton iterations of a round; a step that gains energy from nothing makes up to `rounds` rounds, and one "
       "that is far from its minimum up to three"},
      s.iterations, Range::between(1, 10000));
  s.history =
      table.integer({"history", "", "window m of L-BFGS; 0 is plain quasi-Newton"}, s.history, Range::between(0, 100));
  s.levels =
      table.integer({"levels", "",
                     "2: the first matrix of quasi-newton's directions knows that turning parts of the body costs "
                     "nothing, unless the body is so soft that it turns all the same; 1: it resists turning, as the "
                     "paper's"},
                    s.levels, Range::between(1, 2));
  s.matrix = table.word<StartMatrix>(
      {"matrix", "",
       "what directions of quasi-newton start from: a matrix that follows the body, or the paper's M/h^2 + L"},
      s.matrix, matrix_words());
  s.chebyshev.delay = table.integer({"chebyshev_delay", "", "iterations of chebyshev before it accelerates"},
                                    s.chebyshev.delay, Range::between(0, 10000));
  s.chebyshev.radius = table.number({"chebyshev_radius", "", "spectral radius that chebyshev assumes of an iteration"},
                                    s.chebyshev.radius, Range::between(0, 0.9999));
  s.line_search =
      table.word<LineSearch>({"line_search", "", "how a step length is accepted; none takes every full step"},
                             s.line_search, {.allowed = all_names<LineSearch>(), .gone = {{"wolfe", "\"armijo\""}}});
  s.armijo = table.number({"armijo", "", "gamma of the sufficient decrease"}, s.armijo, Range::above(0, 0.5));
  s.target_error =
      table.number({"target_error", "", "stop once both of the solver's own error estimates are below; 0: no target"},
                   s.target_error, Range::between(0, 1));
  s.still = table.number({"still", "body sizes",
                          "stop once less than this is left to go, so that what lies still costs next to nothing; 0 or "
                          "levels = 1 does all iterations"},
                         s.still, Range::between(0, 1));
  s.budget_ms = table.number({"budget_ms", "ms",
                              "no iteration of a step begins that would probably end later, except for the first; runs "
                              "then differ, unless --repeat takes their numbers from an earlier run; 0: no bound"},
                             s.budget_ms, Range::at_least(0));
  s.elements = table.word<Precision>({"elements", "",
                                      "single: elements are evaluated in single precision where that is enough; what a "
                                      "step leaves and reports is always "
                                      "double"},
                                     s.elements);
  s.rounds = table.integer({"rounds", "",
                            "a step whose answer gains energy from nothing goes on, for so many times `iterations` in "
                            "all, and one of a solid that is far from its minimum for up to three; one that still does "
                            "or is, is finished by Newton's method; 1: none of these"},
                           s.rounds, Range::between(1, 100));
  return s;
}

}  // namespace

SolverDef read_solver(const ConfigTable& table, const SolverDef& defaults) {
  SolverDef solver = defaults;
  solver.method = read_method(table, defaults.method);
  solver.settings = read_settings(table, defaults.settings);
  solver.untangle = table.boolean({"untangle", "",
                                   "a step that starts with elements inverted or without volume is made as if the "
                                   "material were as-rigid-as-possible"},
                                  defaults.untangle);
  solver.fit.start = table.number({"fit_from", "", "start of the stretch interval of equation 11"}, defaults.fit.start,
                                  Range::between(0.01, 0.999));
  solver.fit.end = table.number({"fit_to", "", "end of the stretch interval of equation 11"}, defaults.fit.end,
                                Range::between(1.001, 10));
  if (const auto contact = table.table({"contact", "", "with colliders"}))
    solver.settings.contact = read_contact(*contact, defaults.settings.contact);
  solver.precision = table.word<Precision>(
      {"factor", "", "precision of the factor of M/h^2 + L, hence of directions; energies are always double"},
      defaults.precision);
  solver.integrator = table.word<Integrator>({"integrator", "",
                                              "backward Euler damps and is stable; implicit midpoint damps nothing, "
                                              "keeps energy where steps are short, and may fail"},
                                             defaults.integrator);
  solver.damping =
      table.number({"damping", "s", "beta of stiffness-proportional damping; also slows turning as a whole"},
                   defaults.damping, Range::at_least(0));
  solver.calming = table.number({"calming", "1/s",
                                 "rate at which movement within a body dies down; falling, turning and swinging as a "
                                 "whole go on"},
                                defaults.calming, Range::at_least(0));
  return solver;
}

}  // namespace supple
