#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"
#include "geometry/skins/skin.h"

namespace supple {
namespace {

constexpr double crease = 0.64;  // cosine of 50 degrees: faces that meet at a larger angle do not share a normal

struct Corner {
  std::int32_t face;
  int place;  // the corner's place in its triangle, 0 to 2
};

// Groups the corners at one vertex: faces that share an edge there without a crease belong together. Returns a label
// for each corner.
std::vector<int> groups_of(const std::vector<Corner>& corners, const Triangles& triangles, const Positions& normals) {
  DisjointSets groups(corners.size());
  std::map<std::int32_t, std::vector<int>> by_neighbour;  // by the other end of an edge: the corners at the edge
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (int step = 1; step <= 2; ++step)
      by_neighbour[triangles(corners[i].face, (corners[i].place + step) % 3)].push_back(static_cast<int>(i));
  }
  for (const auto& [neighbour, sharing] : by_neighbour) {
    for (std::size_t k = 1; k < sharing.size(); ++k) {
      if (normals.row(corners[sharing[0]].face).dot(normals.row(corners[sharing[k]].face)) > crease)
        groups.join(std::size_t(sharing[k]), std::size_t(sharing[0]));
    }
  }
  std::vector<int> label;
  for (std::size_t i = 0; i < corners.size(); ++i) label.push_back(static_cast<int>(groups.of(i)));
  return label;
}

}  // namespace

Skin skin_of_surface(const Positions& points, const Triangles& triangles, double square,
                     std::vector<std::int32_t>& vertex_of) {
  Positions normals(triangles.rows(), 3);
  std::vector<std::vector<Corner>> around(points.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto corner = [&](int k) -> Vec3 { return points.row(triangles(t, k)); };
    normals.row(t) = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized().transpose();
    for (int k = 0; k < 3; ++k) around[triangles(t, k)].push_back({static_cast<std::int32_t>(t), k});
  }
  Skin skin;
  skin.rest.triangles.resize(triangles.rows(), 3);
  vertex_of.clear();
  const Vec3 origin = bounds_of(points).lower;
  for (std::int32_t v = 0; v < points.rows(); ++v) {
    const std::vector<int> group = groups_of(around[v], triangles, normals);
    std::map<int, std::int32_t> name;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const auto [at, added] = name.try_emplace(group[i], static_cast<std::int32_t>(vertex_of.size()));
      skin.rest.triangles(around[v][i].face, around[v][i].place) = at->second;
      if (!added) continue;
      vertex_of.push_back(v);
      if (square <= 0) continue;
      int faced = 0;
      normals.row(around[v][i].face).cwiseAbs().maxCoeff(&faced);
      const Vec3 at_rest = (Vec3(points.row(v)) - origin) / square;
      const int first = faced == 0 ? 2 : 0, second = faced == 1 ? 2 : 1;
      skin.square.push_back({static_cast<float>(at_rest[first]), static_cast<float>(at_rest[second])});
    }
  }
  skin.rest.points.resize(static_cast<Eigen::Index>(vertex_of.size()), 3);
  for (std::size_t v = 0; v < vertex_of.size(); ++v)
    skin.rest.points.row(static_cast<Eigen::Index>(v)) = points.row(vertex_of[v]);
  skin.occlusion.assign(vertex_of.size(), 1.0f);
  skin.paint.resize(vertex_of.size());
  for (auto& layers : skin.paint) layers.fill(1e3f);
  return skin;
}

}  // namespace supple
