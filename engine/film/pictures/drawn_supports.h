// Draws what holds the bodies of a film (scene/building/support.h): meshes that stand after those of bodies and
// colliders, and go along with the vertices that are held.
#pragma once

#include <vector>

#include "film/pictures/surface_field.h"
#include "scene/building/support.h"

namespace supple {

struct SceneDef;

class DrawnSupports {
 public:
  // Adds the meshes to the stage, after all that it has. The bodies must outlive this object.
  DrawnSupports(const std::vector<Body>& bodies, Stage& stage);

  // Adds the meshes' positions to a list that already holds those of the bodies and colliders. A support whose handle
  // holds nothing at the time is not seen.
  void add_to(DrawList& list, const SceneDef& scene, const FramePose& pose) const;

 private:
  struct Drawn {
    Support support;
    std::vector<std::int32_t> held;  // the vertices of its handle
  };
  const std::vector<Body>& bodies_;
  std::vector<std::vector<Drawn>> supports_;  // by body
};

}  // namespace supple
