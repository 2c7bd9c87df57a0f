// Names a scene, a replay or a model: by its file, or as a text that came from standard input and stands for a file in
// the working folder.
#pragma once

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace supple {

struct SceneSource {
  static constexpr const char* standard_input = "<stdin>";  // in the place of a file's name

  std::filesystem::path path;       // the file that messages name, and beside which files lie that the scene names
  std::optional<std::string> text;  // the scene's text; nothing: the text is in the file

  template <std::convertible_to<std::filesystem::path> Path>
  SceneSource(const Path& file) : path(file) {}  // NOLINT: a file's name is a source
  SceneSource(std::filesystem::path place, std::string given) : path(std::move(place)), text(std::move(given)) {}

  // Returns the name of the scene, after which a run's folder is called.
  std::string name() const { return path == standard_input ? "stdin" : path.stem().string(); }
};

}  // namespace supple
