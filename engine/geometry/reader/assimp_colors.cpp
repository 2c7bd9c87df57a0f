#include "geometry/reader/assimp_colors.h"

#include <assimp/GltfMaterial.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include "base/text.h"
#include "geometry/files/surface_stream.h"
#include "geometry/reader/texture_reader.h"
#include "geometry/reader/uri_names.h"

namespace supple {
namespace {

namespace fs = std::filesystem;
namespace stream = surface_stream;

std::string small_letters(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

float linear_of(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

float within_one(float value) { return value >= 0 ? std::min(value, 1.0f) : 0.0f; }  // 0 for what is not a number

// Returns a texture coordinate; 0 where it is so large that a float has no digits left for the place in the picture.
float coordinate(float value) { return std::abs(value) < 1e6f ? value : 0.0f; }

Wrap wrap_of(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Mirror) return Wrap::mirror;
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? Wrap::clamp : Wrap::repeat;
}

// Finds a file that a model names; empty where it is not there. Models name files where they were made, often on
// another machine, so that a file of the same name beside the model serves too.
fs::path found_beside(const fs::path& model, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  for (const std::string& one : {name, decoded_uri(name)}) {
    const fs::path path(one), folder = model.parent_path();
    for (const fs::path& place : {folder / path, folder / path.filename(), folder / "textures" / path.filename()}) {
      std::error_code error;
      if (!path.filename().empty() && fs::is_regular_file(place, error)) return place;
    }
  }
  return {};
}

std::string file_name(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return one_line(fs::path(path).filename().string());
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string_view line = text.substr(0, text.find('\n'));
  std::size_t end = 0;  // of the whole characters that are kept
  for (std::size_t next = 0; next <= 200 && next <= line.size();
       next += std::max<std::size_t>(1, first_character(line.substr(next)))) {
    end = next;
  }
  return printable(line.substr(0, end));
}

ColorReader::ColorReader(const aiScene& scene, fs::path file, std::function<void(int)> more_time)
    : scene_(scene),
      file_(std::move(file)),
      ending_(small_letters(file_.extension().string())),
      more_time_(std::move(more_time)) {
  used_.assign(scene.mNumMaterials, false);
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    if (scene.mMeshes[m]->mMaterialIndex < scene.mNumMaterials) used_[scene.mMeshes[m]->mMaterialIndex] = true;
    by_vertex_ |= scene.mMeshes[m]->HasVertexColors(0);
    placed_ |= scene.mMeshes[m]->GetNumUVChannels() > 0;
  }
  any_ = by_vertex_;
  if (ending_ == ".obj") find_library();
  for (unsigned i = 0; i < scene.mNumMaterials; ++i)
    surfaces_.push_back(used_[i] ? surface_of(*scene.mMaterials[i]) : Surface());
}

void ColorReader::remark(std::string text) {
  if (std::find(result_.remarks.begin(), result_.remarks.end(), text) == result_.remarks.end())
    result_.remarks.push_back(std::move(text));
}

// Finds out whether the materials of an OBJ file are there. Where their file is missing, assimp tries one that is named
// as the model. Where that is missing too, it says nothing and makes up grey materials.
void ColorReader::find_library() {
  constexpr std::size_t most_bytes = 1 << 20;  // the line stands before the first faces
  std::string begin(most_bytes, '\0');
  std::ifstream file(file_, std::ios::binary);
  file.read(begin.data(), std::streamsize(begin.size()));
  begin.resize(std::size_t(file.gcount()));
  std::istringstream lines(begin);
  std::error_code error;
  has_library_ = fs::is_regular_file(fs::path(file_).replace_extension(".mtl"), error);
  std::string missing;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("mtllib ")) continue;
    std::string name = line.substr(7);
    name.erase(name.find_last_not_of(" \t\r") + 1);
    const bool there = fs::is_regular_file(file_.parent_path() / name, error);
    has_library_ |= there;
    if (!there) missing = name;
  }
  if (!has_library_ && !missing.empty())
    remark("its materials are missing: there is no file '" + one_line(missing) + "' beside it");
}

// Tells whether a material is one of the file's: assimp makes up others where there are none.
bool ColorReader::has_color(const aiMaterial& material) const {
  if (ending_ == ".ply" || ending_ == ".stl" || ending_ == ".off" || !has_library_) return false;
  aiString name;
  material.Get(AI_MATKEY_NAME, name);
  if (name.length > 0) return std::string(name.C_Str()) != AI_DEFAULT_MATERIAL_NAME;
  aiColor4D base(1, 1, 1, 1);  // the one that is made up for glTF has neither a name nor a colour
  material.Get(AI_MATKEY_BASE_COLOR, base);
  return base.r != 1 || base.g != 1 || base.b != 1;
}

ColorReader::Surface ColorReader::surface_of(const aiMaterial& material) {
  Surface surface;
  const bool gltf = ending_ == ".gltf" || ending_ == ".glb";
  aiColor4D base;
  if (has_color(material) && ((gltf && material.Get(AI_MATKEY_BASE_COLOR, base) == aiReturn_SUCCESS) ||
                              material.Get(AI_MATKEY_COLOR_DIFFUSE, base) == aiReturn_SUCCESS)) {
    surface.own = true;
    const auto linear = [&](float c) { return gltf ? within_one(c) : linear_of(within_one(c)); };
    surface.color = {linear(base.r), linear(base.g), linear(base.b)};
  }
  for (const aiTextureType kind : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (material.GetTextureCount(kind) == 0) continue;
    aiString path;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    material.GetTexture(kind, 0, &path, nullptr, &surface.channel, nullptr, nullptr, modes);
    int channel = 0;
    if (material.Get("$tex.file.texCoord", kind, 0, channel) == aiReturn_SUCCESS && channel >= 0)
      surface.channel = unsigned(channel);
    surface.color.texture = texture_of(path, modes, surface.texture_name);
    // Only glTF says that both are multiplied. Elsewhere the colour is often left black or grey below a texture.
    if (surface.color.texture >= 0 && !gltf) surface.color = {1, 1, 1, surface.color.texture};
    break;
  }
  surface.own |= surface.color.texture >= 0;
  any_ |= surface.own;
  aiString alpha;
  float opacity = 1;
  const bool opaque_gltf = gltf && (material.Get(AI_MATKEY_GLTF_ALPHAMODE, alpha) != aiReturn_SUCCESS ||
                                    std::string(alpha.C_Str()) == "OPAQUE");
  material.Get(AI_MATKEY_OPACITY, opacity);
  if (surface.own && !opaque_gltf && (gltf || opacity < 1)) remark("transparency of its materials is not drawn");
  return surface;
}

std::int32_t ColorReader::texture_of(const aiString& path, const aiTextureMapMode* modes, std::string& name) {
  const aiTexture* inside = scene_.GetEmbeddedTexture(path.C_Str());
  name = inside == nullptr ? file_name(path.C_Str()) : file_name(inside->mFilename.C_Str());
  if (name.empty()) name = "inside the file";
  const std::string key = std::string(path.C_Str()) + '\n' + std::to_string(modes[0]) + std::to_string(modes[1]);
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  std::string refusal;
  const std::string bytes = bytes_of(path, inside, refusal);
  std::int32_t number = -1;
  if (refusal.empty() && std::ssize(result_.textures) >= stream::most_textures) refusal = "is one of more than 64";
  if (refusal.empty()) number = keep_texture(bytes, name, refusal);
  if (number >= 0) {
    result_.textures.back().wrap_u = wrap_of(modes[0]);
    result_.textures.back().wrap_v = wrap_of(modes[1]);
  } else {
    remark("texture '" + name + "' " + refusal + "; the base colour is drawn in its place");
  }
  return known_[key] = number;
}

std::string ColorReader::bytes_of(const aiString& path, const aiTexture* inside, std::string& refusal) const {
  if (inside != nullptr) {
    if (inside->mHeight == 0) return std::string(reinterpret_cast<const char*>(inside->pcData), inside->mWidth);
    refusal = "is neither PNG, JPEG, TGA nor BMP";
    return "";
  }
  const fs::path place = found_beside(file_, path.C_Str());
  if (place.empty()) {
    refusal = "is missing: there is no such file beside the model";
    return "";
  }
  constexpr std::uintmax_t largest = 1u << 28;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(place, error);
  if (error || size > largest) {
    refusal = error ? "cannot be read" : "is larger than 256 MiB";
    return "";
  }
  std::string bytes(size, '\0');
  std::ifstream file(place, std::ios::binary);
  if (!file.read(bytes.data(), std::streamsize(size))) refusal = "cannot be read";
  return bytes;
}

std::int32_t ColorReader::keep_texture(const std::string& bytes, const std::string& name, std::string& refusal) {
  more_time_(10);
  ReadTexture read =
      read_texture(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), stream::most_pixels - pixels_);
  refusal = one_line(read.refusal);
  if (!refusal.empty()) return -1;
  if (read.transparent) remark("transparency of texture '" + name + "' is not drawn");
  if (read.damaged) remark("texture '" + name + "' is damaged: parts of it may be grey");
  pixels_ += std::int64_t(read.texture.width) * read.texture.height;
  read.texture.name = name;
  result_.textures.push_back(std::move(read.texture));
  return std::int32_t(result_.textures.size()) - 1;
}

void ColorReader::append_places(const aiMesh& mesh) {
  unsigned channel = mesh.mMaterialIndex < surfaces_.size() ? surfaces_[mesh.mMaterialIndex].channel : 0;
  if (!mesh.HasTextureCoords(channel)) channel = 0;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D* place = mesh.HasTextureCoords(channel) ? &mesh.mTextureCoords[channel][v] : nullptr;
    const bool within = place != nullptr && std::abs(place->x) < 1e6f && std::abs(place->y) < 1e6f;
    result_.places.push_back(within ? std::array{place->x, place->y} : std::array{none, none});
  }
}

void ColorReader::append(const aiMesh& mesh) {
  if (placed_) append_places(mesh);
  if (!any_) return;
  Surface surface;
  if (mesh.mMaterialIndex < surfaces_.size()) surface = surfaces_[mesh.mMaterialIndex];
  const bool colored = mesh.HasVertexColors(0), gltf = ending_ == ".gltf" || ending_ == ".glb";
  if (surface.color.texture >= 0 && !mesh.HasTextureCoords(surface.channel)) {
    remark("texture '" + surface.texture_name + "' cannot be laid onto parts without texture coordinates");
    surface.color.texture = -1;
  }
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    SurfaceColor color = surface.color;
    if (color.texture >= 0) {
      color.u = coordinate(mesh.mTextureCoords[surface.channel][v].x);
      color.v = coordinate(mesh.mTextureCoords[surface.channel][v].y);
    }
    if (colored && gltf) {
      const aiColor4D& own = mesh.mColors[0][v];
      color.red *= within_one(own.r);
      color.green *= within_one(own.g);
      color.blue *= within_one(own.b);
    } else if (colored && color.texture < 0) {
      const aiColor4D& own = mesh.mColors[0][v];
      color.red = linear_of(within_one(own.r));
      color.green = linear_of(within_one(own.g));
      color.blue = linear_of(within_one(own.b));
    }
    result_.by_vertex.push_back(color);
  }
}

FoundColors ColorReader::take() {
  if (!any_) return {{}, {}, std::move(result_.places), std::move(result_.remarks), ""};
  std::string& found = result_.found;
  const auto say = [&found](const std::string& text) { found += (found.empty() ? "" : ", ") + text; };
  if (by_vertex_) say("of vertices");
  std::size_t materials = 0;
  for (const Surface& surface : surfaces_) materials += surface.own ? 1 : 0;
  if (materials > 0) say(std::to_string(materials) + (materials == 1 ? " material" : " materials"));
  for (std::size_t t = 0; t < result_.textures.size() && t < 12; ++t) {
    const Texture& texture = result_.textures[t];
    say("texture '" + texture.name + "' of " + std::to_string(texture.width) + " x " + std::to_string(texture.height));
  }
  return std::move(result_);
}

}  // namespace supple
