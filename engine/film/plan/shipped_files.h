// Finds the files that come with the program: beside the installed program, or in the source tree that it was
// built from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/font.h"
#include "scene/definition/text_def.h"
#include "scene/reading/scene_source.h"

namespace supple {

std::filesystem::path assets_folder();
std::filesystem::path shaders_folder();

// Returns the names of the files in a folder of assets ("scenes", "shapes"), sorted; empty when there is no such
// folder.
std::vector<std::string> shipped_names(const std::string& kind);

// Returns the font of a film's words: that of the family that its text asks for, or else a usual sans-serif one; empty
// when none is installed. Throws InputError when the family is not.
Font text_font(const TextDef& text = {});

// Returns the scene or replay that a user means: a file, or the name of one that ships ("squirrel"). Throws InputError
// where there is neither.
std::filesystem::path scene_file(const std::string& name);
// Does the same, and takes "-" for standard input, which it reads. Throws InputError.
SceneSource scene_source(const std::string& name);

}  // namespace supple
