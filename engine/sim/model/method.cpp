#include "sim/model/method.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"

namespace supple {
namespace {

template <class E>
std::optional<MethodProblem> problem_of_part(const char* part, E value, const PartChoice<E>& allowed,
                                             const std::string& beside) {
  if (allowed.contains(value)) return std::nullopt;
  std::vector<std::string> names;
  for (const E other : allowed) names.emplace_back(name_of(other));
  return MethodProblem{part,
                       fmt::format("{} = '{}': with {} it must be {}", part, name_of(value), beside, word_list(names))};
}

std::vector<std::string> linear_solvers_for(StartMatrix matrix) {
  std::vector<std::string> names;
  for (const MethodForm& form : method_forms) {
    if (form.matrix == matrix) names.emplace_back(name_of(form.linear));
  }
  return names;
}

const ShortName* short_name_of(const Method& method) {
  const auto at = std::find_if(short_names.begin(), short_names.end(),
                               [&](const ShortName& entry) { return entry.method == method; });
  return at == short_names.end() ? nullptr : &*at;
}

}  // namespace

std::vector<std::string> method_matrices() {
  std::vector<std::string> names;
  for (const MethodForm& form : method_forms) {
    const std::string_view name = name_of(form.matrix);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
  }
  return names;
}

std::optional<MethodProblem> problem_of(const Method& method) {
  const std::string matrix = fmt::format("matrix = '{}'", name_of(method.matrix));
  const MethodForm* form = form_of(method.matrix, method.linear);
  if (form == nullptr && linear_solvers_for(method.matrix).empty())
    return MethodProblem{"matrix", fmt::format("{}: must be {}", matrix, word_list(method_matrices()))};
  if (form == nullptr) {
    return MethodProblem{"linear", fmt::format("linear = '{}': with {} it must be {}", name_of(method.linear), matrix,
                                               word_list(linear_solvers_for(method.matrix)))};
  }
  const std::string both = fmt::format("{} and linear = '{}'", matrix, name_of(method.linear));
  if (auto problem = problem_of_part("preconditioner", method.preconditioner, form->preconditioner, both))
    return problem;
  if (auto problem = problem_of_part("acceleration", method.acceleration, form->acceleration, both)) return problem;
  if (auto problem = problem_of_part("safeguard", method.safeguard, form->safeguard, both)) return problem;
  if ((method.linear == LinearSolver::cg) != (method.inner_iterations > 0)) {
    return MethodProblem{"inner_iterations", fmt::format("inner_iterations = {}: must be at least 1 with linear = "
                                                         "'cg', and 0 with 'direct'",
                                                         method.inner_iterations)};
  }
  const bool newton_cg = method.matrix == StartMatrix::hessian && method.linear == LinearSolver::cg;
  if (method.inner_tolerance != 0 && !newton_cg) {
    return MethodProblem{"inner_tolerance",
                         fmt::format("inner_tolerance = {:g}: must be 0 but with matrix = 'hessian' and linear = 'cg'",
                                     method.inner_tolerance)};
  }
  return std::nullopt;
}

std::string name_of(const Method& method) {
  if (const ShortName* known = short_name_of(method)) return std::string(known->name);
  std::string text(name_of(method.matrix));
  if (method.linear == LinearSolver::cg)
    text += fmt::format(", {} cg ({})", method.inner_iterations, name_of(method.preconditioner));
  if (method.inner_tolerance > 0) text += fmt::format(" to {:g}", method.inner_tolerance);
  const MethodForm* form = form_of(method.matrix, method.linear);
  if (form == nullptr || method.acceleration != form->acceleration.usual())
    text += method.acceleration == Acceleration::none ? ", not accelerated"
                                                      : fmt::format(", {}", name_of(method.acceleration));
  if (form == nullptr || method.safeguard != form->safeguard.usual())
    text += fmt::format(", {}", name_of(method.safeguard));
  return text;
}

std::string spelling_of(const Method& method) {
  if (const ShortName* known = short_name_of(method)) return fmt::format("\"{}\"", known->name);
  std::string text = fmt::format("{{ matrix = \"{}\"", name_of(method.matrix));
  if (method.linear == LinearSolver::cg)
    text += fmt::format(", linear = \"cg\", inner_iterations = {}", method.inner_iterations);
  if (method.inner_tolerance > 0) text += fmt::format(", inner_tolerance = {:g}", method.inner_tolerance);
  const MethodForm* form = form_of(method.matrix, method.linear);
  // A preconditioner is written wherever there is a choice of several, because such a method is known by its
  // preconditioner.
  if (form == nullptr || form->preconditioner.begin() + 1 != form->preconditioner.end())
    text += fmt::format(", preconditioner = \"{}\"", name_of(method.preconditioner));
  if (form == nullptr || method.acceleration != form->acceleration.usual())
    text += fmt::format(", acceleration = \"{}\"", name_of(method.acceleration));
  if (form == nullptr || method.safeguard != form->safeguard.usual())
    text += fmt::format(", safeguard = \"{}\"", name_of(method.safeguard));
  return text + " }";
}

}  // namespace supple
