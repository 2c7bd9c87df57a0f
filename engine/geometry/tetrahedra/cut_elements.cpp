#include "geometry/tetrahedra/cut_elements.h"

#include <utility>

namespace supple {

TetMesh oriented_mesh(const std::vector<Eigen::RowVector3d>& vertices, const std::vector<std::array<int, 4>>& tets) {
  TetMesh mesh;
  mesh.rest.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.rest.row(static_cast<Eigen::Index>(v)) = vertices[v];
  mesh.tets.resize(static_cast<Eigen::Index>(tets.size()), 4);
  for (std::size_t e = 0; e < tets.size(); ++e) {
    for (int k = 0; k < 4; ++k) mesh.tets(static_cast<Eigen::Index>(e), k) = tets[e][static_cast<std::size_t>(k)];
    if (tet_volume(mesh, static_cast<Eigen::Index>(e)) < 0)
      std::swap(mesh.tets(static_cast<Eigen::Index>(e), 2), mesh.tets(static_cast<Eigen::Index>(e), 3));
  }
  return mesh;
}

}  // namespace supple
