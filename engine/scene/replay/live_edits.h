// Defines what is done to a scene while it is played: values that change, and vertices that are grabbed. A replay's
// file can say the same (Script::replay_files).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/config/config_value.h"
#include "scene/definition/keyed_motion.h"
#include "scene/replay/live_keys.h"

namespace supple {

// Describes a change of one value while the film runs.
struct TimedChange {
  std::string path;    // as --set takes it
  std::string object;  // the name of the body or collider that the value belongs to; empty: the whole scene
  double at = 0;       // when the change begins [s]
  double over = 0;     // how long the change takes; 0: a jump [s]
  Ease ease = Ease::smooth;
  RampRule by = RampRule::difference;
  bool whole = false;  // whether the values of a ramp are rounded to whole numbers
  ChangeCost cost;
  std::optional<ConfigValue> from;  // where a ramp begins
  ConfigValue to;
  FilePlace place;

  // Returns the share of the change that is done at a time [s], 0 to 1, or nothing before the change begins.
  std::optional<double> done_at(double time) const;
};

// Returns all that these changes require to be recomputed for one body or collider.
ChangeCost cost_for(const std::string& name, const std::vector<TimedChange>& changes);

// Describes a handle that grabs vertices of a body where they are. Its keys, which changes give, are joined evenly
// (Ease::linear).
struct LiveGrab {
  std::string body, name;
  std::vector<int> vertices;  // numbers, counted from 1
  double stiffness = 0;       // stiffness of the spring from each vertex to its target [N/m]
  double from = 0, until = std::numeric_limits<double>::infinity();  // [s]
};

// Lists the changes and the grabs that were made, each in the order in which they were made.
struct LiveEdits {
  std::vector<TimedChange> changes;
  std::vector<LiveGrab> grabs;
  bool empty() const { return changes.empty() && grabs.empty(); }
};

}  // namespace supple
