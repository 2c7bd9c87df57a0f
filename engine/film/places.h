// Finds the files that come with the program: beside the installed program, or in the source tree that it was
// built from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

std::filesystem::path assets_folder();
std::filesystem::path shaders_folder();

// Names of the files in a folder of assets ("scenes", "shapes"), sorted; empty when there is no such folder.
std::vector<std::string> shipped_names(const std::string& kind);

// A sans font for captions; empty when none of the known ones is installed.
std::string caption_font();

// The scene or replay that a user means: a file, or the name of one that ships ("squirrel").
std::filesystem::path scene_file(const std::string& name);

}  // namespace supple
