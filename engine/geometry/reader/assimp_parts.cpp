#include "geometry/reader/assimp_parts.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "geometry/reader/assimp_colors.h"
#include "geometry/reader/checked_surface.h"

namespace supple {
namespace {

void add(const std::string& name, std::vector<std::string>& names) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

// Adds the names of an object and its group, each on one line, but not those that assimp makes up where the file has
// none.
void add_own(const aiString& assimp_name, std::vector<std::string>& names) {
  std::istringstream both(assimp_name.C_Str());
  for (std::string name; std::getline(both, name, end_of_name);) {
    std::ranges::replace(name, space_in_name, ' ');
    name = one_line(name);
    const bool made_up = name == AI_DEFAULT_MATERIAL_NAME || name == "defaultobject" || name.starts_with('<');
    if (!made_up) add(name, names);
  }
}

// Returns the name without the number that each of several primitives of a glTF mesh has behind it ("shirt-0"); empty
// where there is no number.
std::string without_number(const std::string& name) {
  const std::size_t end = name.find_last_not_of("0123456789");
  return end == std::string::npos || end == 0 || end + 1 == name.size() || name[end] != '-' ? "" : name.substr(0, end);
}

}  // namespace

PartReader::Format PartReader::format_of(const aiMesh& mesh) {
  Format format = {mesh.HasNormals(), mesh.HasTangentsAndBitangents()};
  for (unsigned c = 0; c < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.HasTextureCoords(c); ++c)
    format.push_back(mesh.mNumUVComponents[c] == 3 ? 3 : 2);
  for (unsigned c = 0; c < AI_MAX_NUMBER_OF_COLOR_SETS && mesh.HasVertexColors(c); ++c) format.push_back(4);
  return format;
}

void PartReader::visit(const aiScene& scene, const aiNode& node, std::vector<std::string> above) {
  // The root often has the name of the file or of its format; where it has meshes, it is a node of the file's.
  if (node.mParent != nullptr || node.mNumMeshes > 0) add_own(node.mName, above);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    Instance instance{mesh.mMaterialIndex, format_of(mesh), mesh.mNumVertices, {}};
    aiString material;
    if (mesh.mMaterialIndex < scene.mNumMaterials) scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, material);
    add_own(material, instance.names);
    add_own(mesh.mName, instance.names);
    add(without_number(one_line(mesh.mName.C_Str())), instance.names);
    for (const std::string& name : above) add(name, instance.names);
    instances_.push_back(std::move(instance));
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) visit(scene, *node.mChildren[c], above);
}

void PartReader::remember(const aiScene& scene) {
  if (scene.mRootNode != nullptr) visit(scene, *scene.mRootNode, {});
}

SurfaceParts PartReader::parts_of(const aiScene& joined, std::vector<std::string>& remarks) const {
  if (std::ranges::all_of(instances_, [](const Instance& one) { return one.names.empty(); })) return {};
  SurfaceParts parts;
  std::map<std::vector<std::string>, std::int32_t> known;
  for (unsigned m = 0; m < joined.mNumMeshes; ++m) {
    const aiMesh& mesh = *joined.mMeshes[m];
    std::size_t vertices = 0;
    for (const Instance& instance : instances_) {
      if (instance.material != mesh.mMaterialIndex || instance.format != format_of(mesh)) continue;
      const auto [at, added] = known.try_emplace(instance.names, std::int32_t(parts.names.size()));
      if (added) parts.names.push_back(instance.names);
      parts.of.insert(parts.of.end(), instance.vertices, at->second);
      vertices += instance.vertices;
    }
    if (vertices == mesh.mNumVertices) continue;
    remarks.emplace_back("the names of its groups and materials could not be read");
    return {};
  }
  return parts;
}

}  // namespace supple
