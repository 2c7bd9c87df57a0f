// The mesh that a body's definition names: read, or made of a shape, a box or a grid.
#pragma once

#include <map>

#include "geometry/cloth.h"
#include "scene/scene_def.h"

namespace supple {

struct Loaded {
  TetMesh mesh;                      // of cloth only its vertices
  std::vector<std::string> regions;  // names by tag
  std::vector<std::string> notes;
  std::string source;
  std::vector<SourceFile> files;
  ClothMesh cloth;
  TriMesh skin;  // of a body made from a surface, as it was read
};

// Meshes that several bodies share are read or made once.
class MeshCache {
 public:
  // Throws InputError.
  const Loaded& get(const SceneDef& scene, const BodyDef& def);

 private:
  std::map<std::string, Loaded> loaded_;
};

}  // namespace supple
