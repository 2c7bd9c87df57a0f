#include "geometry/solids/sign_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace supple {
namespace {

constexpr int block = 4;  // points along an edge of the blocks that are sampled whole or not at all

// Holds which blocks are near triangles, and the winding number at every fourth point.
struct Blocks {
  Eigen::Vector3i count;
  std::vector<char> near;
  std::vector<float> winding;  // at the blocks' lowest points, with one layer more at the end of each axis

  std::size_t at(int i, int j, int k) const { return (std::size_t(k) * count.y() + j) * count.x() + i; }
  std::size_t corner(int i, int j, int k) const { return (std::size_t(k) * (count.y() + 1) + j) * (count.x() + 1) + i; }
};

void mark_near(const TriangleSoup& soup, const SignGrid& grid, Blocks& blocks) {
  const TriMesh& mesh = soup.mesh();
  const double edge = block * grid.cell, half = 0.5 * edge + grid.cell;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    Bounds box;
    for (int k = 0; k < 3; ++k) box.include(mesh.points.row(mesh.triangles(t, k)).transpose());
    const Vec3 normal = soup.normals().row(t), start = mesh.points.row(mesh.triangles(t, 0));
    const auto block_of = [&](const Vec3& p) -> Eigen::Vector3i {
      return ((p - grid.origin) / edge).array().floor().cast<int>().max(0).min(blocks.count.array() - 1);
    };
    const Eigen::Vector3i low = block_of(box.lower - Vec3::Constant(grid.cell)),
                          high = block_of(box.upper + Vec3::Constant(grid.cell));
    const double reach = half * normal.cwiseAbs().sum();
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) {
          const Vec3 middle = grid.position(block * (i + 0.5), block * (j + 0.5), block * (k + 0.5));
          if (std::abs(normal.dot(middle - start)) <= reach) blocks.near[blocks.at(i, j, k)] = 1;
        }
      }
    }
  }
}

// Finds which points of a block are inside, all at once.
void sample_block(const TriangleSoup& soup, const Eigen::Vector3i& low, const Eigen::Vector3i& high, SignGrid& grid) {
  std::vector<Vec3> places;
  std::vector<double> windings;
  std::vector<std::size_t> points;
  for (int k = low.z(); k < high.z(); ++k) {
    for (int j = low.y(); j < high.y(); ++j) {
      for (int i = low.x(); i < high.x(); ++i) {
        places.push_back(grid.position(i, j, k));
        points.push_back(grid.at(i, j, k));
      }
    }
  }
  soup.winding_numbers(places, windings);
  for (std::size_t n = 0; n < points.size(); ++n) grid.inside[points[n]] = windings[n] > 0.5;
}

// Fills one layer of blocks. Where no triangle is near, the winding number is smooth: it passes 1/2 within a block only
// where it does so from corner to corner of the block, or comes close to 1/2 at a corner.
void fill_layer(const TriangleSoup& soup, const Blocks& blocks, int bk, SignGrid& grid) {
  constexpr float margin = 0.1f;
  for (int bj = 0; bj < blocks.count.y(); ++bj) {
    for (int bi = 0; bi < blocks.count.x(); ++bi) {
      float low = 1e30f, high = -1e30f;
      for (int c = 0; c < 8; ++c) {
        const float w = blocks.winding[blocks.corner(bi + (c & 1), bj + (c >> 1 & 1), bk + (c >> 2))];
        low = std::min(low, w);
        high = std::max(high, w);
      }
      const bool smooth = !blocks.near[blocks.at(bi, bj, bk)];
      const bool all_in = smooth && low > 0.5f + margin, all_out = smooth && high < 0.5f - margin;
      if (all_out) continue;
      const Eigen::Vector3i first = block * Eigen::Vector3i(bi, bj, bk);
      const Eigen::Vector3i last = (first.array() + block).min(grid.points.array());
      if (!all_in) {
        sample_block(soup, first, last, grid);
        continue;
      }
      for (int k = first.z(); k < last.z(); ++k)
        for (int j = first.y(); j < last.y(); ++j)
          for (int i = first.x(); i < last.x(); ++i) grid.inside[grid.at(i, j, k)] = 1;
    }
  }
}

// Puts the two outermost layers of points outside, because the boundary is closed only then (surface_nets.h). Round-off
// alone could put a point inside that lies beside the triangles' box.
void clear_border(SignGrid& grid) {
  const Eigen::Vector3i last = grid.points.array() - 1;
  for (int k = 0; k <= last.z(); ++k) {
    for (int j = 0; j <= last.y(); ++j) {
      for (int i = 0; i <= last.x(); ++i) {
        const int to_border = std::min({i, j, k, last.x() - i, last.y() - j, last.z() - k});
        if (to_border < 2) grid.inside[grid.at(i, j, k)] = 0;
      }
    }
  }
}

}  // namespace

double suitable_cell(const TriMesh& mesh) {
  constexpr double cells_on_area = 4e4, most_points = 4e7;
  double area = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return mesh.points.row(mesh.triangles(t, k)); };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  const Vec3 extent = bounds_of(mesh.points).extent();
  const double longest = extent.maxCoeff();
  double cell = std::clamp(std::sqrt(area / cells_on_area), longest / 500, longest / 64);
  while ((extent.array() / cell + 8).prod() > most_points) cell *= 1.1;
  return cell;
}

SignGrid sampled_signs(const TriangleSoup& soup, double cell, Threads& threads) {
  const Bounds box = bounds_of(soup.mesh().points);
  SignGrid grid;
  grid.cell = cell;
  // The lattice is shifted by an odd share of a cell, so that it misses the planes of models made on a grid.
  grid.origin = box.lower - Vec3(2.637, 2.591, 2.613) * cell;
  grid.points = (box.extent() / cell).array().ceil().cast<int>() + 6;
  grid.inside.assign(std::size_t(grid.points.x()) * std::size_t(grid.points.y()) * std::size_t(grid.points.z()), 0);
  Blocks blocks;
  blocks.count = (grid.points.array() + block - 1) / block;
  blocks.near.assign(std::size_t(blocks.count.prod()), 0);
  blocks.winding.resize(std::size_t((blocks.count.array() + 1).prod()));
  mark_near(soup, grid, blocks);
  threads.run(blocks.count.z() + 1, [&](int k) {
    std::vector<Vec3> places;
    std::vector<double> windings;
    for (int j = 0; j <= blocks.count.y(); ++j)
      for (int i = 0; i <= blocks.count.x(); ++i) places.push_back(grid.position(block * i, block * j, block * k));
    soup.winding_numbers(places, windings);
    std::transform(windings.begin(), windings.end(), blocks.winding.begin() + std::ptrdiff_t(blocks.corner(0, 0, k)),
                   [](double winding) { return float(winding); });
  });
  threads.run(blocks.count.z(), [&](int k) { fill_layer(soup, blocks, k, grid); });
  clear_border(grid);
  return grid;
}

namespace {

using Cube = std::array<char, 8>;  // by corner: bit 0 is x, bit 1 is y, bit 2 is z

Cube cube_at(const SignGrid& grid, const Eigen::Vector3i& cell) {
  Cube cube;
  for (int c = 0; c < 8; ++c)
    cube[std::size_t(c)] = grid.inside[grid.at(cell.x() + (c & 1), cell.y() + (c >> 1 & 1), cell.z() + (c >> 2))];
  return cube;
}

// Returns a corner that must join the inside for the cube's boundary to be a manifold; -1 where it is one.
int missing_corner(const Cube& cube) {
  const auto in = [&](int c) { return cube[std::size_t(c)] != 0; };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    for (const int base : {0, 1 << axis}) {  // of each of the two faces across the axis
      const bool a = in(base), b = in(base + u), c = in(base + v), d = in(base + u + v);
      if (a == d && b == c && a != b) return a ? base + u : base;
    }
  }
  int count = 0;
  for (int c = 0; c < 8; ++c) count += in(c) ? 1 : 0;
  if (count != 2 && count != 6) return -1;
  for (int c = 0; c < 4; ++c) {
    if (in(c) != in(7 - c) || in(c) != (count == 2)) continue;
    return count == 2 ? c ^ 1 : c;  // two opposite corners are joined along the edges, or filled
  }
  return -1;
}

}  // namespace

void make_well_composed(SignGrid& grid) {
  std::vector<Eigen::Vector3i> waiting;
  for (int k = 0; k + 1 < grid.points.z(); ++k) {
    for (int j = 0; j + 1 < grid.points.y(); ++j) {
      for (int i = 0; i + 1 < grid.points.x(); ++i)
        if (missing_corner(cube_at(grid, {i, j, k})) >= 0) waiting.push_back({i, j, k});
    }
  }
  while (!waiting.empty()) {
    const Eigen::Vector3i cell = waiting.back();
    const int corner = missing_corner(cube_at(grid, cell));
    if (corner < 0) {
      waiting.pop_back();
      continue;
    }
    const Eigen::Vector3i point = cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
    grid.inside[grid.at(point.x(), point.y(), point.z())] = 1;
    for (int c = 0; c < 8; ++c) {
      const Eigen::Vector3i other = point - Eigen::Vector3i(c & 1, c >> 1 & 1, c >> 2);
      const bool in_grid = other.minCoeff() >= 0 && (other.array() + 1 < grid.points.array()).all();
      if (in_grid && missing_corner(cube_at(grid, other)) >= 0) waiting.push_back(other);
    }
  }
}

TriMesh boundary_of(const SignGrid& grid) {
  const auto value = [&](std::size_t point) { return grid.inside[point] != 0 ? -1.0f : 1.0f; };
  return triangles_of(surface_nets(grid, value), Diagonal::first);
}

}  // namespace supple
