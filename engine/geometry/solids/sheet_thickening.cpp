// Gives sheets a thickness, so that they enclose a volume.
#include <Eigen/Geometry>
#include <cmath>

#include "base/disjoint_sets.h"
#include "geometry/solids/surface_closing.h"

namespace supple {
namespace {

using CornerNames = std::vector<std::int32_t>;

// Says of each triangle's edges whether a neighbour continues the sheet there with the same side up.
std::vector<std::array<Eigen::Index, 3>> continuations(const Neighbours& next, const std::vector<char>& turned) {
  std::vector<std::array<Eigen::Index, 3>> result(next.of.size());
  for (std::size_t t = 0; t < next.of.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Neighbour& other = next.of[t][k];
      const bool even = other.triangle >= 0 && other.alike == (turned[t] == turned[at(other.triangle)]);
      result[t][k] = even ? other.triangle : -1;
    }
  }
  return result;
}

// Names the corners, three for each triangle: those around a vertex that edges connect have one name, and no others do.
CornerNames corner_names(const Triangles& triangles, const std::vector<std::array<Eigen::Index, 3>>& next,
                         std::int32_t& count) {
  DisjointSets corners(at(3 * triangles.rows()));
  const auto join = [&](Eigen::Index t, int k, Eigen::Index other) {
    for (int j = 0; j < 3; ++j)
      if (triangles(other, j) == triangles(t, k)) corners.join(at(3 * t + k), at(3 * other + j));
  };
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (next[at(t)][at(k)] < 0) continue;
      join(t, k, next[at(t)][at(k)]);
      join(t, (k + 1) % 3, next[at(t)][at(k)]);
    }
  }
  CornerNames name(corners.size(), -1), result(corners.size());
  count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::int32_t& own = name[corners.of(i)];
    if (own < 0) own = count++;
    result[i] = own;
  }
  return result;
}

// Returns a unit normal for each name: that of the sum of the triangles' normals, weighted by their angles there.
Positions offsets_of(const TriMesh& mesh, const CornerNames& name, std::int32_t count) {
  Positions sum = Positions::Zero(count, 3);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const Vec3 normal = area_vector(mesh, t).stableNormalized();
    for (int k = 0; k < 3; ++k) {
      const Vec3 l = corner(mesh, t, (k + 1) % 3) - corner(mesh, t, k);
      const Vec3 r = corner(mesh, t, (k + 2) % 3) - corner(mesh, t, k);
      sum.row(name[at(3 * t + k)]) += std::atan2(l.cross(r).norm(), l.dot(r)) * normal.transpose();
    }
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    const double length = sum.row(v).norm();
    if (length > 0) sum.row(v) /= length;
  }
  return sum;
}

}  // namespace

Thickened thickened(const Numbered& surface, double thickness) {
  const Neighbours found = neighbours_of(surface);
  const Flood parts = flood(surface, found);
  const auto before_turns = continuations(found, parts.turned);
  TriMesh mesh = surface.mesh;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    if (parts.turned[at(t)]) turn_over(mesh.triangles, t);
  auto next = before_turns;  // a turned triangle's edges stand in the opposite order
  for (std::size_t t = 0; t < next.size(); ++t)
    if (parts.turned[t]) std::swap(next[t][0], next[t][2]);

  std::vector<char> is_sheet(next.size(), 0);
  Thickened result;
  for (const Component& part : parts.components) {
    bool rim = false;
    for (const Eigen::Index t : part.triangles)
      for (const Eigen::Index other : next[at(t)]) rim |= other < 0;
    result.sheets += rim ? 1 : 0;
    for (const Eigen::Index t : part.triangles) is_sheet[at(t)] = rim;
  }

  std::int32_t count = 0;
  const CornerNames name = corner_names(mesh.triangles, next, count);
  const Positions offsets = 0.5 * thickness * offsets_of(mesh, name, count);
  TriMesh& out = result.boundary;
  out.points.resize(2 * count, 3);  // the upper side first; of closed parts both are the vertex itself
  std::vector<std::array<std::int32_t, 3>> faces;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const std::int32_t* own = name.data() + 3 * t;
    const double share = is_sheet[at(t)] ? 1 : 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d point = mesh.points.row(mesh.triangles(t, k)), offset = share * offsets.row(own[k]);
      out.points.row(own[k]) = point + offset;
      out.points.row(own[k] + count) = point - offset;
    }
    faces.push_back({own[0], own[1], own[2]});
    if (!is_sheet[at(t)]) continue;
    faces.push_back({own[0] + count, own[2] + count, own[1] + count});
    for (int k = 0; k < 3; ++k) {
      if (next[at(t)][at(k)] >= 0) continue;
      const std::int32_t from = own[k], to = own[(k + 1) % 3];
      faces.push_back({from + count, to + count, to});
      faces.push_back({from + count, to, from});
    }
  }
  out.triangles.resize(std::ssize(faces), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    out.triangles.row(Eigen::Index(f)) << faces[f][0], faces[f][1], faces[f][2];
  return result;
}

}  // namespace supple
