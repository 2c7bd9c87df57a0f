// Makes a SceneDef from a parsed file. docs/scene-format.md lists all keys that are read here, and a test compares the
// two.
#pragma once

#include "scene/config/config.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Reads the scene. Records problems in the config; the result may be used only if there are none.
SceneDef read_scene(Config& config);

// Loads a file, applies the "path=value" settings in order, and reads the scene. resolved_json: where not null, gets
// the document with the settings. Throws InputError with all problems.
SceneDef load_scene(const std::filesystem::path& path, const std::filesystem::path& assets,
                    const std::vector<std::string>& settings, std::string* resolved_json = nullptr);

// Returns groups of keys of which a table may have only one: setting one removes the others of its group.
const std::vector<std::set<std::string>>& exclusive_keys();

}  // namespace supple
