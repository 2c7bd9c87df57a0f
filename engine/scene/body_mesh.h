// The mesh that a body's definition names. It is read from a file, or made from a shape, a box or a grid.
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

// Reads or makes each mesh once, also when several bodies share it.
class MeshCache {
 public:
  // Throws InputError.
  const Loaded& get(const SceneDef& scene, const BodyDef& def);

 private:
  std::map<std::string, Loaded> loaded_;
};

}  // namespace supple
