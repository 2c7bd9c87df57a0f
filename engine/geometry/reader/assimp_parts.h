// Keeps the names of a file's parts while assimp joins its meshes: those of materials, of groups or meshes, and of
// nodes. A part of supple-read-surface.
#pragma once

#include <assimp/scene.h>

#include <string>
#include <vector>

#include "geometry/files/colored_surface.h"

namespace supple {

class PartReader {
 public:
  // Takes the names of a scene with all its nodes.
  void remember(const aiScene& scene);

  // Returns the part of each vertex of all meshes. joined: the remembered scene after its nodes were dropped, before it
  // is triangulated. There are no parts where nothing has a name. There are none either, and a remark says so, where
  // the meshes are not those that were remembered.
  SurfaceParts parts_of(const aiScene& joined, std::vector<std::string>& remarks) const;

 private:
  // Describes which of a mesh's vertices have normals and the like: assimp joins meshes that agree in it.
  using Format = std::vector<unsigned>;

  struct Instance {
    unsigned material;
    Format format;
    unsigned vertices;
    std::vector<std::string> names;  // none twice
  };

  static Format format_of(const aiMesh& mesh);
  void visit(const aiScene& scene, const aiNode& node, std::vector<std::string> above);

  std::vector<Instance> instances_;  // meshes as nodes have them, in the order in which assimp joins them
};

}  // namespace supple
