// Defines a collider as a scene describes it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/finish.h"
#include "geometry/shapes/shape.h"
#include "scene/definition/keyed_motion.h"
#include "scene/definition/surface_motion.h"

namespace supple {

// Describes an obstacle. Its shape is given in its own frame.
struct ColliderDef {
  std::string name;
  Shape shape;
  Vec3 position = Vec3(0, 0, 0);  // of its origin [m]
  Vec3 turn_deg = Vec3(0, 0, 0);
  double friction = 0;
  double restitution = 0;  // the share of its speed that a body keeps at least when it bounces off the collider
  double thickness = 0;    // [m]
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;
  std::optional<SurfaceMotionDef> motion;  // how its surface deforms; nothing: it is rigid
  bool visible = true;
  std::optional<Vec3> color;  // [sRGB]
  Finish finish;
  FilePlace place;
};

}  // namespace supple
