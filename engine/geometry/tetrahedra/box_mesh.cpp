#include "geometry/tetrahedra/tetrahedralize.h"

namespace supple {

TetMesh box_mesh(const Vec3& extent, const Eigen::Vector3i& cells) {
  const Eigen::Vector3i points = cells.array() + 1;
  const auto name = [&](int i, int j, int k) { return (k * points.y() + j) * points.x() + i; };
  TetMesh mesh;
  mesh.rest.resize(points.prod(), 3);
  for (int k = 0; k < points.z(); ++k) {
    for (int j = 0; j < points.y(); ++j) {
      for (int i = 0; i < points.x(); ++i) {
        mesh.rest.row(name(i, j, k)) =
            extent.cwiseProduct(Vec3(i, j, k)).cwiseQuotient(cells.cast<double>()).transpose();
      }
    }
  }
  // These are Kuhn's six tetrahedra: one for each order in which the three axes can be walked from the low to the high
  // corner.
  constexpr int walks[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  mesh.tets.resize(6 * cells.cast<Eigen::Index>().prod(), 4);
  Eigen::Index row = 0;
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        for (const auto& walk : walks) {
          int step[3] = {0, 0, 0};
          for (int corner = 0; corner < 4; ++corner) {
            if (corner > 0) step[walk[corner - 1]] = 1;
            // The walk is mirrored in odd cells.
            const auto at = [](int cell, int s) { return cell + (cell % 2 == 0 ? s : 1 - s); };
            mesh.tets(row, corner) = name(at(i, step[0]), at(j, step[1]), at(k, step[2]));
          }
          if (tet_volume(mesh, row) < 0) std::swap(mesh.tets(row, 2), mesh.tets(row, 3));
          ++row;
        }
      }
    }
  }
  mesh.regions.assign(static_cast<std::size_t>(mesh.tets.rows()), 0);
  return mesh;
}

}  // namespace supple
