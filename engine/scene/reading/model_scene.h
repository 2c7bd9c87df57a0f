// Makes a scene of a model's file alone, for a first look at it: the model is stood up, is so stiff that it sags only a
// little under its own weight, and falls from a low height onto the ground, where a camera shows all of its motion.
// `--set` changes it as it does any scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/solids/solid_surface.h"
#include "scene/config/config.h"
#include "scene/reading/scene_source.h"

namespace supple {

// Tells whether a file is a mesh or a surface by the ending of its name, and so stands for the scene above.
bool is_model(const std::filesystem::path& path);

// Holds those settings of the scene of a model to which the stiffness of the model is fitted.
struct ModelWish {
  std::optional<UpAxis> up;  // the axis of its file; nothing: it is guessed
  double size = 0.5;         // its longest side [m]
};

// Returns what settings such as "body.model.size=2" say of these. Those that cannot be read are left to the reader of
// the scene.
ModelWish wish_of(const std::vector<std::string>& settings);

struct ModelScene {
  // Tells what was chosen for the model.
  struct Note {
    std::string text;                // a line
    std::vector<std::string> about;  // the keys whose settings make it untrue
  };
  std::string text;  // text of the scene, as if its file lay beside the model
  std::vector<Note> notes;

  // Returns the lines that are true where these settings replace values of the scene.
  std::vector<std::string> notes_with(const std::vector<std::string>& settings) const;
};

// Makes the scene of a model. Reads its file and tries how it sags, which takes some seconds. Throws InputError.
ModelScene model_scene(const std::filesystem::path& model, const ModelWish& wish = {});

// Loads a scene or replay, or the scene of a model. Throws InputError as Config::load does.
Config load_document(const SceneSource& source, const std::filesystem::path& assets);

}  // namespace supple
