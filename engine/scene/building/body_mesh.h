// Provides the mesh that a body's definition names. It is read from a file, or generated from a shape, a box or a grid.
#pragma once

#include <map>

#include "base/slow_work.h"
#include "geometry/meshes/cloth.h"
#include "geometry/skins/surface_colors.h"
#include "scene/definition/scene_def.h"

namespace supple {

struct Loaded {
  TetMesh mesh;                      // of cloth only its vertices
  std::vector<std::string> regions;  // names by tag
  std::vector<std::string> notes;
  std::string source;
  std::vector<SourceFile> files;
  ClothMesh cloth;
  TriMesh skin;                                 // of a body made from a surface, as it was read
  std::shared_ptr<const SurfaceColors> colors;  // of that skin; null where it has the body's own
  Positions whole;  // of a body that is one of several pieces: the vertices of all of them; else empty
  Shape shape;      // of a body made from a shape
};

// Reads or makes each mesh once, also when several bodies share it. Meshes that take long to make are kept from run to
// run.
class MeshCache {
 public:
  explicit MeshCache(const SlowWork& work = {}) : work_(work) {}

  // Throws InputError.
  const Loaded& get(const SceneDef& scene, const BodyDef& def);

 private:
  const SlowWork work_;
  std::map<std::string, Loaded> loaded_;
};

// Names what files say, whatever their places are.
std::string content_name(const std::vector<SourceFile>& files);

}  // namespace supple
