// Makes the scene that a replay starts with.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scene/config/config.h"

namespace supple {

// Tells whether a document is a replay, not a scene.
bool is_replay(Config& document);

// Returns the file of the scene that a replay names: one that ships, or a file in the replay's folder. Empty where
// there is no such file; the problem is then recorded in the replay.
std::filesystem::path replayed_scene(Config& replay, const std::filesystem::path& assets);

// Returns the document of the scene that a replay names, with the replay's title, frames, [set] and grabs in it.
// Problems of the replay are added to `problems`; `put` puts a value of [set] in its place, and tells of problems by
// itself. Throws InputError when the scene cannot be read.
using PutsValue =
    std::function<void(Config& document, const std::string& path, const ConfigValue& value, const FilePlace& place)>;
Config start_of_replay(Config& replay, const std::filesystem::path& assets, std::vector<Problem>& problems,
                       const PutsValue& put);

}  // namespace supple
