// Holds the solvers that scenes can name. Most of them are in a library that worlds do not depend on, so they are
// passed in.
#pragma once

#include <functional>
#include <memory>

#include "sim/model/inputs.h"
#include "sim/model/method.h"

namespace supple {

class SearchRule;
struct Model;

// Solvers{make_rule, settings_of} are all of them (baselines/make_rule.h).
struct Solvers {
  // Makes a rule for the directions of one body's steps. It is called again when the method or the model's values
  // change. For steps of bodies that touch each other or themselves it is asked for quasi-Newton directions, and has to
  // give them: other rules do not know such contacts, and would leave the bodies where they are.
  std::function<std::unique_ptr<SearchRule>(const Method&, const Model&)> rule;
  // Returns the settings of a step: the scene's, except for those that the method fixes.
  std::function<SolverSettings(const Method&, SolverSettings)> settings;
};

}  // namespace supple
