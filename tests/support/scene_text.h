// Scenes written in a test.
#pragma once

#include <string>
#include <vector>

#include "scene/scene_def.h"

namespace supple::test {

// All that is wrong with a scene called "scene.toml".
std::vector<std::string> problems_of(const std::string& text);

// A scene with nothing wrong.
SceneDef scene_of(const std::string& text);

}  // namespace supple::test
