#include "geometry/meshes/cloth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace supple {

ClothMesh cloth_grid(const Eigen::Vector2d& extent, const Eigen::Vector2i& cells) {
  ClothMesh cloth;
  const int columns = cells.x() + 1, rows = cells.y() + 1;
  const auto name = [columns](int i, int j) { return static_cast<std::int32_t>(j * columns + i); };
  cloth.surface.points.resize(columns * rows, 3);
  cloth.surface.triangles.resize(2 * cells.prod(), 3);
  Eigen::Index triangle = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      cloth.surface.points.row(name(i, j)) << extent.x() * i / cells.x(), extent.y() * j / cells.y(), 0;
      if (i + 1 < columns) cloth.edges.push_back({name(i, j), name(i + 1, j)});
      if (j + 1 < rows) cloth.edges.push_back({name(i, j), name(i, j + 1)});
      if (i + 2 < columns) cloth.bends.push_back({name(i, j), name(i + 2, j)});
      if (j + 2 < rows) cloth.bends.push_back({name(i, j), name(i, j + 2)});
      if (i + 1 == columns || j + 1 == rows) continue;
      const std::int32_t corner[4] = {name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)};
      const int from = (i + j) % 2;  // the diagonal joins corners `from` and `from + 2`
      cloth.diagonals.push_back({corner[from], corner[from + 2]});
      cloth.surface.triangles.row(triangle++) << corner[from], corner[from + 1], corner[from + 2];
      cloth.surface.triangles.row(triangle++) << corner[from], corner[from + 2], corner[(from + 3) % 4];
    }
  }
  return cloth;
}

ClothMesh cloth_of(TriMesh surface) {
  ClothMesh cloth;
  std::map<VertexPair, std::vector<std::int32_t>> opposite;  // the third corners of the triangles at each edge
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      VertexPair edge{surface.triangles(t, k), surface.triangles(t, (k + 1) % 3)};
      std::sort(edge.begin(), edge.end());
      opposite[edge].push_back(surface.triangles(t, (k + 2) % 3));
    }
  }
  for (const auto& [edge, corners] : opposite) {
    cloth.edges.push_back(edge);
    for (std::size_t i = 1; i < corners.size(); ++i) {
      if (corners[i] != corners[0]) cloth.bends.push_back({corners[0], corners[i]});
    }
  }
  cloth.surface = std::move(surface);
  return cloth;
}

std::vector<double> vertex_areas(const TriMesh& surface) {
  std::vector<double> areas(surface.points.rows(), 0.0);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return surface.points.row(surface.triangles(t, k)); };
    const double third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[surface.triangles(t, k)] += third;
  }
  return areas;
}

}  // namespace supple
