// Lists the values of a scene that may change while its film runs, and what must be recomputed when they do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/config/config_value.h"

namespace supple {

class Config;

// Tells what must be recomputed when a value changes. For most values that is nothing.
struct ChangeCost {
  bool factor = false;   // A and its factor: the body's stiffness, mass or time step
  bool rule = false;     // what the method keeps from step to step
  bool surface = false;  // the drawn surface of a collider
  // Whether replays try the value before they run: nothing is recomputed, but only a body that has been built can tell
  // whether it can take the value.
  bool trial = false;

  ChangeCost& operator|=(const ChangeCost& other);
  const char* text() const;  // for people; empty when nothing is made anew
};

// Returns the cost of a change of a path in the form that --set takes ("body.soft.material.mu"), or nothing when the
// value cannot change.
std::optional<ChangeCost> cost_of_change(const std::string& path);

// Replaces the names of list elements: "body[].material.mu" for "body.soft.material.mu".
std::string generic_path(const std::string& path);

// Describes a value of a scene that may change. live_keys() lists them in the order in which the readers asked for
// them.
struct LiveKey {
  KnownKey key;
  ChangeCost cost;
};
std::vector<LiveKey> live_keys(const Config& config);

}  // namespace supple
