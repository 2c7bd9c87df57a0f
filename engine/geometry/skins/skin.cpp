#include "geometry/skins/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/skins/shape_surface.h"
#include "geometry/triangles/surface_nets.h"

namespace supple {
namespace {

// Returns a grid over the shape's box, with at least one layer of empty cells around it.
PointGrid grid_around(const Shape& shape, double cell) {
  const Bounds box = shape.bounds();
  return {box.lower - Vec3::Constant(1.5 * cell), cell, (box.extent() / cell).array().ceil().cast<int>() + 4};
}

std::vector<float> sampled_field(const Shape& shape, const PointGrid& grid) {
  std::vector<float> field(grid.size());
  for (int k = 0; k < grid.points.z(); ++k) {
    for (int j = 0; j < grid.points.y(); ++j) {
      // A distance field cannot change faster than the point moves, so far from the surface most samples follow from
      // the last one.
      double known = 0;
      int skip = 0;
      for (int i = 0; i < grid.points.x(); ++i) {
        if (skip > 0) {
          --skip;
        } else {
          known = shape.distance(grid.position(i, j, k));
          skip = std::max(0, static_cast<int>(0.5 * std::abs(known) / grid.cell) - 3);
        }
        field[grid.at(i, j, k)] = static_cast<float>(known);
      }
    }
  }
  return field;
}

// Estimates how open the sky over a point is, by how far the field falls short of free space along the normal (Evans
// 2006, "Fast approximations for global illumination on dynamic scenes", with the shape's own field).
float openness(const Shape& shape, const Vec3& point, const Vec3& normal, double size) {
  double blocked = 0, weight = 0.55;
  for (int ring = 1; ring <= 5; ++ring) {
    const double reach = 0.016 * size * ring * ring * 0.6;
    blocked += weight * std::clamp(1 - shape.distance(point + reach * normal) / reach, 0.0, 1.0);
    weight *= 0.62;
  }
  return static_cast<float>(std::clamp(1 - 0.95 * blocked, 0.0, 1.0));
}

}  // namespace

Vec3 onto_surface(const Shape& shape, const Vec3& start, double reach) {
  Vec3 point = start;
  for (int step = 0; step < 4; ++step) {
    const double d = shape.distance(point);
    if (std::abs(d) < 1e-4 * reach) break;
    const Vec3 slope = shape.gradient(point, 0.02 * reach);
    const double steepness2 = slope.squaredNorm();
    if (steepness2 < 1e-4) break;
    point -= d * slope / steepness2;
  }
  return (point - start).norm() < reach ? point : start;
}

TriMesh contour(const Shape& shape, double cell) {
  const PointGrid grid = grid_around(shape, cell);
  const std::vector<float> field = sampled_field(shape, grid);
  QuadSurface surface = surface_nets(grid, [&](std::size_t point) { return field[point]; });
  for (Vec3& point : surface.points) point = onto_surface(shape, point, cell);
  return triangles_of(surface, Diagonal::shorter);
}

Skin skin_of(const Shape& shape, double cell) {
  Skin skin;
  skin.rest = contour(shape, cell);
  const double size = bounds_of(skin.rest.points).diagonal();
  skin.occlusion.resize(skin.rest.points.rows());
  skin.paint.resize(skin.rest.points.rows());
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v) {
    const Vec3 point = skin.rest.points.row(v);
    const Vec3 normal = shape.gradient(point, 0.1 * cell).normalized();
    skin.occlusion[v] = openness(shape, point, normal, size);
    skin.paint[v].fill(1e3f);
    for (std::size_t layer = 0; layer < shape.paint.size(); ++layer) {
      skin.paint[v][layer] = static_cast<float>(distance(shape.paint[layer].area, point));
    }
  }
  return skin;
}

}  // namespace supple
