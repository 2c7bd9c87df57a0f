#include "scene/replay/script_trial.h"

#include <algorithm>

namespace supple {
namespace {

// Returns the only change at work that affects a body's model; null where there are none or several.
const TimedChange* only_change(const std::vector<const TimedChange*>& at_work, const std::string& body) {
  const TimedChange* only = nullptr;
  for (const TimedChange* change : at_work) {
    if (!(change->cost.factor || change->cost.trial) || (!change->object.empty() && change->object != body)) continue;
    if (only != nullptr) return nullptr;
    only = change;
  }
  return only;
}

}  // namespace

void try_changes(const Script& script, std::vector<Body> bodies) {
  std::vector<Problem> problems;
  const auto tell = [&problems](Problem problem) {
    const auto same = [&problem](const Problem& p) { return p.text() == problem.text(); };
    if (std::none_of(problems.begin(), problems.end(), same)) problems.push_back(std::move(problem));
  };
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    const std::vector<const TimedChange*> at_work = script.at_work(frame);
    if (std::none_of(at_work.begin(), at_work.end(),
                     [](const TimedChange* change) { return change->cost.factor || change->cost.trial; }))
      continue;
    const SceneDef scene = script.scene_at(frame);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      try {
        update_body(bodies[b], scene, scene.bodies[b]);
      } catch (const InputError& error) {
        const TimedChange* change = only_change(at_work, scene.bodies[b].table);
        for (const Problem& problem : error.problems())
          tell({change != nullptr ? change->place : problem.place, problem.message});
        bodies[b].def = scene.bodies[b];  // so that later changes answer for themselves alone
      }
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

std::vector<Warning> all_warnings(const Script& script, const std::vector<Body>& bodies) {
  std::vector<Warning> list = warnings(script.scene(), bodies);
  for (Problem& of_time : script.warnings()) list.push_back({std::nullopt, std::move(of_time)});
  return list;
}

}  // namespace supple
