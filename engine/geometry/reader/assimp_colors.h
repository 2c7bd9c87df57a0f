// Finds the colours of a scene that assimp has read: those of vertices, of materials, and of textures inside the file
// or beside it. A part of supple-read-surface.
#pragma once

#include <assimp/scene.h>

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/texture.h"

namespace supple {

struct FoundColors {
  std::vector<SurfaceColor> by_vertex;  // of all meshes; empty where the file has no colours
  std::vector<Texture> textures;
  // Texture coordinates by vertex of all meshes: those of the material's texture, or else the first ones; not a number
  // where a mesh has none. Empty where no mesh has any.
  std::vector<std::array<float, 2>> places;
  std::vector<std::string> remarks;  // on what is missing or not drawn
  std::string found;                 // which colours there are, in words; empty: none
};

class ColorReader {
 public:
  // more_time: called before a picture is decoded, with the seconds that it may take.
  ColorReader(const aiScene& scene, std::filesystem::path file, std::function<void(int)> more_time);

  // Appends the colours and the texture coordinates of a mesh's vertices.
  void append(const aiMesh& mesh);
  FoundColors take();

 private:
  struct Surface {
    SurfaceColor color;        // with the number of the texture
    unsigned channel = 0;      // of the texture's coordinates
    std::string texture_name;  // empty: it has none
    bool own = false;          // whether the file says its colour or texture
  };

  void append_places(const aiMesh& mesh);
  Surface surface_of(const aiMaterial& material);
  bool has_color(const aiMaterial& material) const;
  std::int32_t texture_of(const aiString& path, const aiTextureMapMode* modes, std::string& name);
  std::string bytes_of(const aiString& path, const aiTexture* inside, std::string& refusal) const;
  std::int32_t keep_texture(const std::string& bytes, const std::string& name, std::string& refusal);
  void find_library();
  void remark(std::string text);

  const aiScene& scene_;
  const std::filesystem::path file_;
  const std::string ending_;  // of the file's name, in small letters
  const std::function<void(int)> more_time_;
  std::vector<Surface> surfaces_;              // by material
  std::map<std::string, std::int32_t> known_;  // textures by path and wrapping; -1: cannot be read
  FoundColors result_;
  std::int64_t pixels_ = 0;
  bool any_ = false, by_vertex_ = false, placed_ = false;
  bool has_library_ = true;  // false for an OBJ file whose materials are not there
  std::vector<bool> used_;   // by material
};

// Returns the first line of a text, cut off after 200 bytes, as a terminal can show it.
std::string one_line(std::string_view text);

}  // namespace supple
