// Finds the files that come with the program: beside the installed program, or in the source tree that it was
// built from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/reading/scene_source.h"

namespace supple {

std::filesystem::path assets_folder();
std::filesystem::path shaders_folder();

// Returns the names of the files in a folder of assets ("scenes", "shapes"), sorted; empty when there is no such
// folder.
std::vector<std::string> shipped_names(const std::string& kind);

// Returns the file of a sans-serif font for captions; empty when none of the known fonts is installed.
std::string caption_font();

// Returns the scene or replay that a user means: a file, or the name of one that ships ("squirrel"). Throws InputError
// where there is neither.
std::filesystem::path scene_file(const std::string& name);
// Does the same, and takes "-" for standard input, which it reads. Throws InputError.
SceneSource scene_source(const std::string& name);

}  // namespace supple
