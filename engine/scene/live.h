// Which values of a scene may change while its film runs, and what a change asks for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/config.h"

namespace supple {

// What must be made anew when a value changes; nothing for most.
struct ChangeCost {
  bool factor = false;   // A and its factor: the body's stiffness, mass or time step
  bool rule = false;     // the method's own state
  bool surface = false;  // the drawn surface of a collider

  ChangeCost& operator|=(const ChangeCost& other);
  const char* text() const;  // for people; empty for nothing
};

// Of a path as --set takes it ("body.soft.material.mu"); nothing where the value is fixed for a film.
std::optional<ChangeCost> cost_of_change(const std::string& path);

// "body[].material.mu" of "body.soft.material.mu".
std::string generic_path(const std::string& path);

// The live values of a scene that has been read, in the order in which its readers asked for them.
struct LiveKey {
  KnownKey key;
  ChangeCost cost;
};
std::vector<LiveKey> live_keys(const Config& config);

}  // namespace supple
