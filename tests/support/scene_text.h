// Reads scenes that are written in a test.
#pragma once

#include <string>
#include <vector>

#include "scene/definition/scene_def.h"

namespace supple::test {

// Returns everything that is wrong with a scene called "scene.toml".
std::vector<std::string> problems_of(const std::string& text);

// Returns the scene of a text in which nothing is wrong.
SceneDef scene_of(const std::string& text);

}  // namespace supple::test
