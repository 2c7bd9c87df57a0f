// Makes a scene of a model's file alone, for a first look at it: a body of jelly, half a metre long, that falls onto
// the ground and is filmed by the usual camera. `--set` changes it as it does any scene.
#pragma once

#include <filesystem>
#include <string>

#include "scene/config/config.h"
#include "scene/reading/scene_source.h"

namespace supple {

// Tells whether a file is a mesh or a surface by the ending of its name, and so stands for the scene above.
bool is_model(const std::filesystem::path& path);

// Returns the text of the scene, whose file lies beside the model.
std::string model_scene(const std::filesystem::path& model);

// Loads a scene or replay, or the scene of a model. Throws InputError as Config::load does.
Config load_document(const SceneSource& source, const std::filesystem::path& assets);

}  // namespace supple
