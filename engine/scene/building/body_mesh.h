// Provides the mesh that a body's definition names. It is read from a file, or generated from a shape, a box or a grid.
#pragma once

#include <map>

#include "base/slow_work.h"
#include "geometry/meshes/cloth.h"
#include "geometry/skins/surface_colors.h"
#include "scene/definition/scene_def.h"

namespace supple {

struct Loaded {
  TetMesh mesh;                      // only the vertices, if the body is cloth
  std::vector<std::string> regions;  // names by tag
  std::vector<std::string> notes;
  std::string source;
  std::vector<SourceFile> files;
  ClothMesh cloth;
  TriMesh skin;                                 // the surface of a body made from one, as it was read
  std::shared_ptr<const SurfaceColors> colors;  // colours of `skin`; null where it has the body's own
  Positions whole;                              // the vertices of all pieces, if the body is one of several; else empty
  Shape shape;                                  // the shape of a body made from one
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

// Returns a name for the content of files, which does not depend on where they are.
std::string content_name(const std::vector<SourceFile>& files);

}  // namespace supple
