// Binds points to a surface, so that they go where it goes: each keeps its place beside the triangle that is nearest to
// it, in axes that turn with that triangle.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

class SurfaceBinding {
 public:
  // Binds points, n x 3, to a surface of at least one triangle [m].
  SurfaceBinding(const TriMesh& surface, const Positions& points);

  // Returns the points, n x 3, where the vertices of the surface are at these places [m].
  Positions points_at(const Positions& vertices) const;

 private:
  struct Bound {
    std::array<std::int32_t, 3> corner;  // vertices of the surface
    Vec3 weights;                        // barycentric, of the place that is nearest
    Vec3 offset;                         // from that place, in the triangle's axes [m]
  };
  std::vector<Bound> bound_;
};

}  // namespace supple
