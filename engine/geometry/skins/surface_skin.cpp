#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"
#include "geometry/skins/flat_charts.h"
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

// Tells of each triangle whether it is in a part of the skin that cannot be printed along two axes: there are triangles
// in this part whose corners face along different axes. Parts hang together by vertices of the skin.
std::vector<char> is_bent(const Triangles& triangles, const std::vector<PrintAxes>& axes) {
  DisjointSets parts(axes.size());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 1; k < 3; ++k) parts.join(std::size_t(triangles(t, k)), std::size_t(triangles(t, 0)));
  }
  std::vector<char> of_part(axes.size(), 0);
  const auto part_of = [&](Eigen::Index t) { return parts.of(std::size_t(triangles(t, 0))); };
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto at = [&](int k) { return axes[std::size_t(triangles(t, k))]; };
    if (at(0) != at(1) || at(0) != at(2)) of_part[part_of(t)] = 1;
  }
  std::vector<char> bent;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) bent.push_back(of_part[part_of(t)]);
  return bent;
}

// Prints squares on the bent parts of a skin, which are laid flat for that, and splits the vertices at seams.
void print_bent_parts(const std::vector<char>& bent, double square, Skin& skin, std::vector<std::int32_t>& vertex_of) {
  std::vector<Eigen::Index> own;
  for (std::size_t t = 0; t < bent.size(); ++t)
    if (bent[t] != 0) own.push_back(Eigen::Index(t));
  if (own.empty()) return;
  const Triangles triangles = skin.rest.triangles(own, Eigen::all);
  const std::vector<LaidTriangle> flat = laid_triangles(skin.rest.points, triangles);
  skin.smooth.clear();
  for (std::int32_t v = 0; v < std::int32_t(vertex_of.size()); ++v) skin.smooth.push_back(v);
  std::vector<char> is_used(vertex_of.size(), 0);
  std::map<std::pair<std::int32_t, std::array<float, 2>>, std::int32_t> name;  // by vertex and place
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t vertex = triangles(Eigen::Index(i), Eigen::Index(k));
      const std::array<float, 2> place = {static_cast<float>(flat[i][k].x() / square),
                                          static_cast<float>(flat[i][k].y() / square)};
      const bool is_first = is_used[std::size_t(vertex)] == 0;
      const auto [at, added] =
          name.try_emplace({vertex, place}, is_first ? vertex : static_cast<std::int32_t>(vertex_of.size()));
      skin.rest.triangles(own[i], Eigen::Index(k)) = at->second;
      if (!added) continue;
      if (is_first) {
        is_used[std::size_t(vertex)] = 1;
        skin.square[std::size_t(vertex)] = place;
        continue;
      }
      vertex_of.push_back(vertex_of[std::size_t(vertex)]);
      skin.square.push_back(place);
      skin.smooth.push_back(vertex);
    }
  }
  if (vertex_of.size() == is_used.size()) skin.smooth.clear();  // there is no seam
}

}  // namespace

Skin skin_of_surface(const Positions& points, const Triangles& triangles, double square,
                     std::vector<std::int32_t>& vertex_of, BentPart bent) {
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
  std::vector<PrintAxes> axes;  // by vertex of the skin
  for (std::int32_t v = 0; v < points.rows(); ++v) {
    const std::vector<int> group = groups_of(around[v], triangles, normals);
    std::map<int, std::int32_t> name;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const auto [at, added] = name.try_emplace(group[i], static_cast<std::int32_t>(vertex_of.size()));
      skin.rest.triangles(around[v][i].face, around[v][i].place) = at->second;
      if (!added) continue;
      vertex_of.push_back(v);
      if (square <= 0) continue;
      axes.push_back(print_axes(normals.row(around[v][i].face)));
      const Vec3 at_rest = (Vec3(points.row(v)) - origin) / square;
      skin.square.push_back(
          {static_cast<float>(at_rest[axes.back().across]), static_cast<float>(at_rest[axes.back().along])});
    }
  }
  const auto place_points = [&] {
    skin.rest.points.resize(static_cast<Eigen::Index>(vertex_of.size()), 3);
    for (std::size_t v = 0; v < vertex_of.size(); ++v)
      skin.rest.points.row(static_cast<Eigen::Index>(v)) = points.row(vertex_of[v]);
  };
  place_points();
  if (square > 0 && bent == BentPart::laid) {
    print_bent_parts(is_bent(skin.rest.triangles, axes), square, skin, vertex_of);
    place_points();
  }
  skin.occlusion.assign(vertex_of.size(), 1.0f);
  skin.paint.resize(vertex_of.size());
  for (auto& layers : skin.paint) layers.fill(1e3f);
  return skin;
}

}  // namespace supple
