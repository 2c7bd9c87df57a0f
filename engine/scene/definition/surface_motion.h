// Defines which motion deforms a collider, and when.
#pragma once

#include <memory>
#include <optional>

namespace supple {

class SolidMotion;  // geometry/shapes/solid_motion.h

// Describes when a collider has the frames of the motion that deforms it.
struct SurfaceMotionDef {
  std::shared_ptr<const SolidMotion> motion;
  std::optional<double> fps;  // nothing: the scene's
  double start = 0;           // when frame `first` is there [s]
  int first = 0;
};

}  // namespace supple
