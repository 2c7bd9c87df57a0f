#include "scene/reading/model_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/read_file.h"
#include "geometry/files/mesh_file.h"

namespace supple {
namespace {

// The endings of surfaces that are often met; assimp reads more of them, in scenes that name them.
constexpr std::array surface_endings = {".obj", ".ply", ".stl", ".off",   ".gltf", ".glb",
                                        ".dae", ".3ds", ".fbx", ".blend", ".3mf",  ".x3d"};

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

// Writes a name as a basic string of TOML.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += static_cast<unsigned char>(c) < 0x20 ? fmt::format("\\u{:04x}", int(c)) : std::string(1, c);
  }
  return text + "\"";
}

}  // namespace

bool is_model(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  return is_mesh_file(path) ||
         std::find(surface_endings.begin(), surface_endings.end(), ending) != surface_endings.end();
}

std::string model_scene(const std::filesystem::path& model) {
  const std::string file = quoted(model.filename().string());
  return fmt::format(
      "title = {}\nframes = 90\n[[body]]\nname = \"model\"\n{} = {}\nmaterial = \"jelly\"\nsize = 0.5\n"
      "position = [0, 0.25, 0]\n[[collider]]\nname = \"ground\"\nshape = {{ half_space = {{ normal = [0, 1, 0] }} }}\n"
      "friction = 0.5\n[camera]\nframes = \"film\"\n[look]\nlabels = false\n",
      file, is_mesh_file(model) ? "mesh" : "surface", file);
}

Config load_document(const SceneSource& source, const std::filesystem::path& assets) {
  const std::filesystem::path& path = source.path;
  if (source.text) return Config::parse_beside(*source.text, path, assets);
  if (!is_model(path)) return Config::load(path, assets);
  check_regular_file(path);
  return Config::parse_beside(model_scene(path), path, assets);
}

}  // namespace supple
