#include "scene/building/body_surface.h"

namespace supple {

Triangles surface_of(const Body& body) {
  return body.def.cloth ? body.cloth.surface.triangles : boundary_faces(body.description.mesh.tets);
}

}  // namespace supple
