// Defines the handles of a body as a scene describes them: which vertices they hold, when, and where they move them.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/definition/keyed_motion.h"
#include "scene/definition/selection.h"

namespace supple {

// Names what takes a handle along: a collider or another body.
struct AttachDef {
  std::string collider, body;  // one of the two is empty
  FilePlace place;
};

struct HandleDef {
  std::string name;
  Selection select;
  double stiffness = 0;  // stiffness of the spring from each vertex to its target; 0: hard [N/m]
  // A handle that grabs holds its vertices from one time to another [s]. Its keys are relative to the vertices'
  // positions when it begins to hold them.
  bool grabs = false;
  double from = 0, until = std::numeric_limits<double>::infinity();
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;
  std::optional<AttachDef> attach;  // what its vertices go with; it then has no keys and takes hold at the start

  // Tells whether the handle holds its vertices in a step that starts at a time [s].
  bool holds_at(double time) const { return time >= from - 1e-9 && time < until - 1e-9; }
};

}  // namespace supple
