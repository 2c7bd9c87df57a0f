// Describes the values that a page can change, as JSON (docs/live.md).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "scene/replay/live_keys.h"

namespace supple {

nlohmann::ordered_json controls_json(const std::vector<LiveKey>& keys);

}  // namespace supple
