// Makes closed surfaces of cleaned triangles: as they are, with caps on their holes, or with a thickness. These are the
// steps between which solid_surface.h chooses; what triangles wind around is in winding_solid.h.
#pragma once

#include <string>
#include <vector>

#include "geometry/triangles/numbered_surface.h"

namespace supple {

// Applies the rules of closed_surface.h to a cleaned surface, and leaves its triangles as they are.
TriMesh closed(Numbered surface, const std::string& name, std::vector<std::string>* notes);

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

struct Thickened {
  TriMesh boundary;  // closed, each part facing outward; parts may overlap
  Eigen::Index sheets = 0;
};

// Replaces each part that has a rim by two copies of itself, half the thickness to either side along the normals of its
// vertices, with a strip around the rim. Edges with more than two triangles, and those where a one-sided surface turns
// over, count as rims. Closed parts stay as they are.
Thickened thickened(const Numbered& surface, double thickness);

}  // namespace supple
