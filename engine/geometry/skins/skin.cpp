#include "geometry/skins/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

// Holds samples of the field on a dense grid over a box, with one layer of empty cells around it.
struct SampleGrid {
  Vec3 origin;
  double cell;
  Eigen::Vector3i points;
  std::vector<float> field;

  std::size_t at(int i, int j, int k) const { return (std::size_t(k) * points.y() + j) * points.x() + i; }
  Vec3 position(int i, int j, int k) const { return origin + cell * Vec3(i, j, k); }
};

SampleGrid sample(const Shape& shape, double cell) {
  const Bounds box = shape.bounds();
  SampleGrid grid{box.lower - Vec3::Constant(1.5 * cell), cell, {}, {}};
  grid.points = (box.extent() / cell).array().ceil().cast<int>() + 4;
  grid.field.resize(std::size_t(grid.points.x()) * grid.points.y() * grid.points.z());
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
          skip = std::max(0, static_cast<int>(0.5 * std::abs(known) / cell) - 3);
        }
        grid.field[grid.at(i, j, k)] = static_cast<float>(known);
      }
    }
  }
  return grid;
}

Vec3 onto_surface(const Shape& shape, Vec3 point, double cell) {
  const Vec3 start = point;
  for (int step = 0; step < 4; ++step) {
    const double d = shape.distance(point);
    if (std::abs(d) < 1e-4 * cell) break;
    const Vec3 slope = shape.gradient(point, 0.02 * cell);
    const double steepness2 = slope.squaredNorm();
    if (steepness2 < 1e-4) break;
    point -= d * slope / steepness2;
  }
  return (point - start).norm() < cell ? point : start;
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

TriMesh contour(const Shape& shape, double cell) {
  const SampleGrid grid = sample(shape, cell);
  std::vector<std::int32_t> name(grid.field.size(), -1);
  std::vector<Vec3> points;
  for (int k = 0; k + 1 < grid.points.z(); ++k) {
    for (int j = 0; j + 1 < grid.points.y(); ++j) {
      for (int i = 0; i + 1 < grid.points.x(); ++i) {
        float value[8];
        int inside = 0;
        for (int c = 0; c < 8; ++c) {
          value[c] = grid.field[grid.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
          inside += value[c] < 0 ? 1 : 0;
        }
        if (inside == 0 || inside == 8) continue;
        Vec3 sum = Vec3::Zero();
        int crossings = 0;
        for (int a = 0; a < 8; ++a) {
          for (int bit = 1; bit < 8; bit <<= 1) {
            const int b = a | bit;
            if (b == a || (value[a] < 0) == (value[b] < 0)) continue;
            const double t = value[a] / (value[a] - value[b]);
            sum += (1 - t) * Vec3(a & 1, a >> 1 & 1, a >> 2) + t * Vec3(b & 1, b >> 1 & 1, b >> 2);
            ++crossings;
          }
        }
        name[grid.at(i, j, k)] = static_cast<std::int32_t>(points.size());
        points.push_back(onto_surface(shape, grid.position(i, j, k) + cell * sum / crossings, cell));
      }
    }
  }

  std::vector<std::array<std::int32_t, 3>> triangles;
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, bool flip) {
    if (flip) std::swap(b, d);
    if ((points[a] - points[c]).squaredNorm() <= (points[b] - points[d]).squaredNorm()) {
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    } else {
      triangles.push_back({a, b, d});
      triangles.push_back({b, c, d});
    }
  };
  for (int k = 1; k + 1 < grid.points.z(); ++k) {
    for (int j = 1; j + 1 < grid.points.y(); ++j) {
      for (int i = 1; i + 1 < grid.points.x(); ++i) {
        const bool here = grid.field[grid.at(i, j, k)] < 0;
        if (here != (grid.field[grid.at(i + 1, j, k)] < 0)) {
          quad(name[grid.at(i, j - 1, k - 1)], name[grid.at(i, j, k - 1)], name[grid.at(i, j, k)],
               name[grid.at(i, j - 1, k)], !here);
        }
        if (here != (grid.field[grid.at(i, j + 1, k)] < 0)) {
          quad(name[grid.at(i - 1, j, k - 1)], name[grid.at(i - 1, j, k)], name[grid.at(i, j, k)],
               name[grid.at(i, j, k - 1)], !here);
        }
        if (here != (grid.field[grid.at(i, j, k + 1)] < 0)) {
          quad(name[grid.at(i - 1, j - 1, k)], name[grid.at(i, j - 1, k)], name[grid.at(i, j, k)],
               name[grid.at(i - 1, j, k)], !here);
        }
      }
    }
  }
  TriMesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) mesh.points.row(v) = points[v];
  mesh.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    mesh.triangles.row(t) << triangles[t][0], triangles[t][1], triangles[t][2];
  return mesh;
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
