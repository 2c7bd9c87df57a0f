// Closes the holes of a surface with caps and leaves its own triangles as they are.
#pragma once

#include "geometry/triangles/numbered_surface.h"

namespace supple {

struct Capped {
  Numbered surface;        // all components oriented alike, with the caps at the end
  Eigen::Index caps = 0;   // how many holes were closed
  double widest = 0;       // the longest side of the box around the widest hole [m]
  Vec3 at = Vec3::Zero();  // the middle of that hole
  std::string refusal;     // why there are no caps; empty: there are
};

// Closes each hole by a fan of triangles around the middle of its rim. Refuses where the surface has an edge with more
// than two triangles, is one-sided, or has a component that is more hole than surface, whose caps would enclose next to
// nothing.
Capped with_caps(const Numbered& surface);

}  // namespace supple
