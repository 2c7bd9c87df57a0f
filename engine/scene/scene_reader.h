// From a parsed file to a SceneDef. docs/scene-format.md lists what is read here; a test keeps the two the same.
#pragma once

#include "scene/config.h"
#include "scene/scene_def.h"

namespace supple {

// Problems are recorded in the config; the result is usable only if there are none.
SceneDef read_scene(Config& config);

// Loads a file, applies "path=value" settings in order, reads. Throws InputError with all problems.
SceneDef load_scene(const std::filesystem::path& path, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings, std::string* resolved_json = nullptr);

// Keys of which a body has one: setting one removes the others.
const std::vector<std::set<std::string>>& exclusive_keys();

}  // namespace supple
