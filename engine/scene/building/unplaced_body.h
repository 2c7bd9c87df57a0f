// Makes bodies as their files have them: a mesh that is read, or generated from a surface, a shape, a box or a grid,
// and what is known of it. They have neither their place nor their substance yet: assemble.h gives them both.
#pragma once

#include <map>
#include <string>

#include "base/slow_work.h"
#include "scene/building/body.h"

namespace supple {

struct SceneDef;

// Reads or makes each mesh once, also when several bodies share it. Meshes that take long to make are kept from run to
// run.
class UnplacedBodies {
 public:
  explicit UnplacedBodies(const SlowWork& work = {}) : work_(work) {}

  // Returns the body of a definition, with a mesh whose vertices are in the file's frame. Throws InputError.
  Body get(const SceneDef& scene, const BodyDef& def);

 private:
  const SlowWork work_;
  std::map<std::string, Body> made_;  // by what the mesh and its looks depend on
};

}  // namespace supple
