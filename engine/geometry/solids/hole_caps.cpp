// Closes the holes of a surface with caps.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/solids/surface_closing.h"

namespace supple {
namespace {

// Caps of more than this share of a component's area are no longer an obvious way to close it: half a ball has 0.5 and
// a sheet 1.
constexpr double largest_cap_share = 0.6;

struct Edge {
  Eigen::Index triangle;
  int k;  // it runs from corner k to corner k + 1
};

int side_from(const Triangles& triangles, Eigen::Index t, std::int32_t vertex) {
  for (int k = 0; k < 3; ++k)
    if (triangles(t, k) == vertex) return k;
  return 0;
}

// Returns the open edge that starts where this one ends, found by going around that vertex from triangle to triangle.
Edge next_open(const Triangles& triangles, const Neighbours& next, Edge edge) {
  const std::int32_t vertex = triangles(edge.triangle, (edge.k + 1) % 3);
  Edge at_vertex{edge.triangle, (edge.k + 1) % 3};
  while (next.of[at(at_vertex.triangle)][at(at_vertex.k)].triangle >= 0) {
    const Eigen::Index other = next.of[at(at_vertex.triangle)][at(at_vertex.k)].triangle;
    at_vertex = {other, side_from(triangles, other, vertex)};
  }
  return at_vertex;
}

struct Rim {
  std::vector<std::array<std::int32_t, 2>> edges;  // in the direction of their triangles
  Vec3 middle = Vec3::Zero();
  double area = 0;  // of the fan around the middle [m^2]
  Bounds box;
};

void measure(const TriMesh& mesh, Rim& rim) {
  double length = 0;
  for (const auto& [from, to] : rim.edges) {
    const Vec3 a = mesh.points.row(from), b = mesh.points.row(to);
    length += (b - a).norm();
    rim.middle += 0.5 * (b - a).norm() * (a + b);
    rim.box.include(a);
  }
  rim.middle /= length;
  for (const auto& [from, to] : rim.edges) {
    const Vec3 a = mesh.points.row(from), b = mesh.points.row(to);
    rim.area += 0.5 * (a - rim.middle).cross(b - rim.middle).norm();
  }
}

std::vector<Rim> rims_of(const TriMesh& mesh, const Neighbours& next, const Component& component) {
  std::vector<Rim> rims;
  std::vector<Edge> open;
  for (const Eigen::Index t : component.triangles)
    for (int k = 0; k < 3; ++k)
      if (next.of[at(t)][at(k)].triangle < 0) open.push_back({t, k});
  const auto place = [&](const Edge& edge) {
    const auto found = std::lower_bound(open.begin(), open.end(), edge, [](const Edge& a, const Edge& b) {
      return std::pair(a.triangle, a.k) < std::pair(b.triangle, b.k);
    });
    return std::size_t(found - open.begin());
  };
  std::vector<char> taken(open.size(), 0);
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (taken[first]) continue;
    // Where a line comes to a vertex again, holes touch there, and what lies between is a rim of its own.
    std::vector<std::array<std::int32_t, 2>> line;
    for (std::size_t i = first; !taken[i]; i = place(next_open(mesh.triangles, next, open[i]))) {
      taken[i] = 1;
      const auto [t, k] = open[i];
      line.push_back({mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3)});
      const auto start =
          std::find_if(line.begin(), line.end(), [&](const auto& edge) { return edge[0] == line.back()[1]; });
      if (start == line.end()) continue;
      Rim rim;
      rim.edges.assign(start, line.end());
      line.erase(start, line.end());
      measure(mesh, rim);
      rims.push_back(std::move(rim));
    }
  }
  return rims;
}

// Appends a fan for each rim; a rim of three edges takes one triangle.
void add_caps(const std::vector<Rim>& rims, Numbered& surface) {
  Eigen::Index points = surface.mesh.points.rows(), triangles = surface.mesh.triangles.rows();
  Eigen::Index new_points = points, new_triangles = triangles;
  for (const Rim& rim : rims) {
    new_points += rim.edges.size() > 3 ? 1 : 0;
    new_triangles += rim.edges.size() > 3 ? std::ssize(rim.edges) : 1;
  }
  surface.mesh.points.conservativeResize(new_points, 3);
  surface.mesh.triangles.conservativeResize(new_triangles, 3);
  surface.number.resize(at(new_triangles), 0);
  for (const Rim& rim : rims) {
    if (rim.edges.size() == 3) {
      surface.mesh.triangles.row(triangles++) << rim.edges[0][1], rim.edges[0][0], rim.edges[2][0];
      continue;
    }
    surface.mesh.points.row(points) = rim.middle.transpose();
    for (const auto& [from, to] : rim.edges) surface.mesh.triangles.row(triangles++) << to, from, std::int32_t(points);
    ++points;
  }
}

}  // namespace

Capped with_caps(const Numbered& surface) {
  const Neighbours next = neighbours_of(surface);
  Capped capped;
  capped.surface = surface;
  if (next.crowded >= 0) capped.refusal = "an edge has more than two triangles";
  const Flood parts = flood(surface, next);
  if (parts.one_sided >= 0) capped.refusal = "the surface is one-sided";
  if (!capped.refusal.empty()) return capped;
  TriMesh& mesh = capped.surface.mesh;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    if (parts.turned[at(t)]) turn_over(mesh.triangles, t);
  // The edges of turned triangles have other numbers.
  const Neighbours turned = neighbours_of(capped.surface);
  std::vector<Rim> all;
  for (const Component& component : parts.components) {
    double area = 0;
    for (Rim& rim : rims_of(mesh, turned, component)) {
      area += rim.area;
      if (rim.box.extent().maxCoeff() > capped.widest) {
        capped.widest = rim.box.extent().maxCoeff();
        capped.at = rim.middle;
      }
      all.push_back(std::move(rim));
    }
    if (area > largest_cap_share * component.area) {
      capped.refusal = fmt::format("caps would have {:.0f} % of the area of the part with {}",
                                   100 * area / component.area, triangle_text(surface, component.triangles.front()));
      return capped;
    }
  }
  capped.caps = std::ssize(all);
  add_caps(all, capped.surface);
  return capped;
}

}  // namespace supple
