// Makes a scene of a model's file alone, for a first look at it: the model is stood up, is as stiff as makes it sag a
// little under its own weight, and falls from a low height onto the ground, where a camera shows all of its motion.
// `--set` changes it as it does any scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/config/config.h"
#include "scene/reading/scene_source.h"

namespace supple {

// Tells whether a file is a mesh or a surface by the ending of its name, and so stands for the scene above.
bool is_model(const std::filesystem::path& path);

struct ModelScene {
  std::string text;                // of the scene, whose file lies beside the model
  std::vector<std::string> notes;  // what was chosen for the model, a line each
};

// Makes the scene. Reads the file and tries how it sags, which takes some seconds. Throws InputError.
ModelScene model_scene(const std::filesystem::path& model);

// Loads a scene or replay, or the scene of a model. Throws InputError as Config::load does.
Config load_document(const SceneSource& source, const std::filesystem::path& assets);

}  // namespace supple
