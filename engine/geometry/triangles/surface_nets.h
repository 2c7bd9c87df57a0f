// Finds the surface between the inside and the outside of a field on a grid, by surface nets: Gibson, Constrained
// elastic surface nets, 1998. Each cell that the surface crosses has one vertex, and each edge of the grid that it
// crosses has a quad between the four cells around it. Not here: where the field comes from, and how vertices are moved
// closer to what it stands for.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Describes the points of a regular grid, of which fields have one value each, x first.
struct PointGrid {
  Vec3 origin = Vec3::Zero();
  double cell = 0;                                   // edge of the cells [m]
  Eigen::Vector3i points = Eigen::Vector3i::Zero();  // their number along each axis

  std::size_t size() const { return at(0, 0, points.z()); }
  std::size_t at(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(points.y()) + std::size_t(j)) * std::size_t(points.x()) + std::size_t(i);
  }
  Vec3 position(double i, double j, double k) const { return origin + cell * Vec3(i, j, k); }
};

struct QuadSurface {
  std::vector<Vec3> points;                        // [m]
  std::vector<std::array<std::int32_t, 4>> quads;  // anticlockwise from outside
};

// Says along which diagonal a quad is cut into triangles.
enum class Diagonal {
  first,    // from its first to its third point
  shorter,  // the first one where both have one length
};
TriMesh triangles_of(const QuadSurface& surface, Diagonal diagonal);

// Returns the place of a cell's vertex, from the cell's lowest corner: the mean of the places where the surface crosses
// the cell's edges. Returns nothing where it crosses none. value: by corner, below 0 inside; bit 0 of a corner's number
// is x, bit 1 is y, bit 2 is z.
std::optional<Vec3> net_vertex(const std::array<float, 8>& value, double cell);

// Returns the surface of a field. value: a function that returns the field's value at a point by the point's number in
// the grid, below 0 inside. The surface is closed where the two outermost layers of points are outside. The grid is
// walked through layer by layer, and the names of two layers' vertices are kept.
template <class Value>
QuadSurface surface_nets(const PointGrid& grid, const Value& value) {
  QuadSurface surface;
  std::array<std::vector<std::int32_t>, 2> names;
  for (auto& layer : names) layer.assign(grid.at(0, 0, 1), -1);
  const auto name = [&](int i, int j, int k) -> std::int32_t& { return names[std::size_t(k % 2)][grid.at(i, j, 0)]; };
  const auto add_vertex = [&](int i, int j, int k) {
    std::array<float, 8> corner;
    for (int c = 0; c < 8; ++c) corner[std::size_t(c)] = value(grid.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
    const std::optional<Vec3> vertex = net_vertex(corner, grid.cell);
    name(i, j, k) = vertex ? std::int32_t(surface.points.size()) : -1;
    if (vertex) surface.points.push_back(grid.position(i, j, k) + *vertex);
  };
  const auto add_quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, bool inside) {
    surface.quads.push_back(inside ? std::array{a, b, c, d} : std::array{a, d, c, b});
  };
  // Adds the quads across the edges that start at a point; all cells around them have names.
  const auto add_quads = [&](int i, int j, int k) {
    const bool here = value(grid.at(i, j, k)) < 0;
    if (here != (value(grid.at(i + 1, j, k)) < 0))
      add_quad(name(i, j - 1, k - 1), name(i, j, k - 1), name(i, j, k), name(i, j - 1, k), here);
    if (here != (value(grid.at(i, j + 1, k)) < 0))
      add_quad(name(i - 1, j, k - 1), name(i - 1, j, k), name(i, j, k), name(i, j, k - 1), here);
    if (here != (value(grid.at(i, j, k + 1)) < 0))
      add_quad(name(i - 1, j - 1, k), name(i, j - 1, k), name(i, j, k), name(i - 1, j, k), here);
  };
  for (int k = 0; k + 1 < grid.points.z(); ++k) {
    for (int j = 0; j + 1 < grid.points.y(); ++j)
      for (int i = 0; i + 1 < grid.points.x(); ++i) add_vertex(i, j, k);
    for (int j = 1; k > 0 && j + 1 < grid.points.y(); ++j)
      for (int i = 1; i + 1 < grid.points.x(); ++i) add_quads(i, j, k);
  }
  return surface;
}

}  // namespace supple
