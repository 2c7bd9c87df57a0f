#include <fmt/core.h>

#include "app/summary.h"

namespace supple {

std::string mesh_summary(const TetMesh& mesh) {
  const MeshQuality q = quality(mesh);
  const Manifoldness m = manifoldness(mesh);
  const Bounds box = bounds_of(mesh.rest);
  std::string text = fmt::format("vertices        {}\nelements        {}\nboundary faces  {}\n", mesh.rest.rows(),
                                 mesh.tets.rows(), boundary_faces(mesh.tets).rows());
  text += fmt::format("extent          {:.4g} x {:.4g} x {:.4g}\nvolume          {:.6g}\n", box.extent().x(),
                      box.extent().y(), box.extent().z(), q.volume);
  text += fmt::format("dihedral angles {:.2f} to {:.2f} degrees\nsmallest volume {:.2e} of the mean\n",
                      q.smallest_dihedral, q.largest_dihedral, q.smallest_volume);
  text += fmt::format("pieces          {}\nboundary        {}\n", m.pieces,
                      m.bad_edges + m.bad_vertices == 0
                          ? "manifold"
                          : fmt::format("touches itself at {} edges and {} vertices", m.bad_edges, m.bad_vertices));
  return text;
}

}  // namespace supple
