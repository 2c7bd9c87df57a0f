#include "geometry/triangles/shared_depth.h"

#include <cmath>
#include <optional>
#include <vector>

#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

// Returns the vertices of a mesh's surface that lie in a box, n x 3 [m].
Positions surface_vertices_in(const PosedMesh& mesh, const Bounds& box) {
  std::vector<char> on_surface(std::size_t(mesh.points.rows()), 0);
  for (Eigen::Index t = 0; t < mesh.surface.rows(); ++t) {
    for (int k = 0; k < 3; ++k) on_surface[std::size_t(mesh.surface(t, k))] = 1;
  }
  std::vector<Eigen::Index> found;
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
    const Vec3 point = mesh.points.row(v).transpose();
    const bool in_box = (point.array() >= box.lower.array()).all() && (point.array() <= box.upper.array()).all();
    if (in_box && on_surface[std::size_t(v)] != 0) found.push_back(v);
  }
  return mesh.points(found, Eigen::all);
}

// Looks for vertices of `inner` that are deeper inside `outer` than what was found so far.
void look_inside(const PosedMesh& inner, const PosedMesh& outer, SharedDepth& deepest) {
  if (outer.tets.rows() == 0) return;
  const Positions vertices = surface_vertices_in(inner, outer.box);
  std::optional<TriangleSoup> surface;  // built only where vertices are inside
  const std::vector<char> inside = inside_elements({outer.points, outer.tets, {}}, vertices);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] == 0) continue;
    if (!surface) surface.emplace(TriMesh{outer.points, outer.surface});
    const Vec3 vertex = vertices.row(Eigen::Index(i)).transpose();
    const double depth = std::sqrt(surface->closest(vertex, 2 * outer.box.diagonal(), Vec3::Zero()).squared);
    if (depth > deepest.depth) deepest = {depth, vertex};
  }
}

}  // namespace

SharedDepth shared_depth(const PosedMesh& a, const PosedMesh& b) {
  SharedDepth deepest;
  look_inside(a, b, deepest);
  look_inside(b, a, deepest);
  return deepest;
}

}  // namespace supple
