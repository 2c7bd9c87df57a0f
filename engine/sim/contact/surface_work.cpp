#include "sim/contact/surface_work.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <utility>

#include "geometry/triangles/triangle_edges.h"
#include "sim/contact/sheet_layer.h"
#include "sim/model/element_view.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

using Work = SurfaceWork::Parts;

constexpr double least_cosine = 0.5;  // least cosine of the normals of two faces between which nothing is sharp

// Lists the triangles of a part, with its vertices numbered as in its own model.
Triangles triangles_of(const Model& model, const Part& part) {
  std::vector<Eigen::Index> own;
  for (Eigen::Index t = 0; t < model.surface.rows(); ++t) {
    if (&model.part_of(model.surface(t, 0)) == &part) own.push_back(t);
  }
  Triangles triangles(std::ssize(own), 3);
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      triangles(static_cast<Eigen::Index>(i), k) = own_vertex(model, part, model.surface(own[i], k));
    }
  }
  return triangles;
}

// Returns the tetrahedra of a part, with its vertices numbered as in its own model.
Tetrahedra elements_of(const Model& model, const Part& part) {
  const Tetrahedra all = tetrahedra_of(model);
  std::vector<Eigen::Index> own;
  for (Eigen::Index e = 0; e < all.rows(); ++e) {
    if (&model.part_of(all(e, 0)) == &part) own.push_back(e);
  }
  Tetrahedra tets(std::ssize(own), 4);
  for (std::size_t i = 0; i < own.size(); ++i)
    for (int k = 0; k < 4; ++k) tets(static_cast<Eigen::Index>(i), k) = own_vertex(model, part, all(own[i], k));
  return tets;
}

std::vector<std::int32_t> points_of(const Part& part, const Triangles& triangles) {
  std::vector<std::int32_t> points;
  for (Eigen::Index i = 0; i < triangles.size(); ++i) points.push_back(joined_vertex(part, triangles.data()[i]));
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Vec3 rest_normal(const Triangles& triangles, Eigen::Index t, const Positions& rest) {
  const Vec3 first = rest.row(triangles(t, 0)).transpose();
  const Vec3 edge = rest.row(triangles(t, 1)).transpose() - first,
             other = rest.row(triangles(t, 2)).transpose() - first;
  return edge.cross(other).normalized();
}

// Returns the two triangles at an edge, first the one that runs from its lower vertex to the higher one; -1 where there
// are not just these two. all: sorted_edges() of the triangles.
std::array<std::int32_t, 2> faces_at(const std::vector<TriangleEdge>& all, const EdgeEnds& edge) {
  const auto ends = [](const TriangleEdge& of) { return std::pair(of.low, of.high); };
  const auto first = std::ranges::lower_bound(all, std::pair(edge[0], edge[1]), {}, ends);
  const auto last = std::ranges::upper_bound(all, std::pair(edge[0], edge[1]), {}, ends);
  const std::span<const TriangleEdge> same(first, last);
  if (same.size() != 2 || same[0].upward == same[1].upward) return {-1, -1};
  const bool is_first = same[0].upward;
  return {same[is_first ? 0 : 1].triangle, same[is_first ? 1 : 0].triangle};
}

// Lists the edges of a surface, with their faces where it is that of a solid.
void list_edges(const Model& model, const Part& part, Work::Surface& surface) {
  EdgesByTriangle all = edges_by_triangle(surface.triangles);
  for (const EdgeEnds& edge : all.edges)
    surface.edges.push_back({joined_vertex(part, edge[0]), joined_vertex(part, edge[1])});
  surface.edge_begin = std::move(all.begin);
  if (!part.solid) return;
  const Positions rest = rows_of(part, model.rest);
  const std::vector<TriangleEdge> sorted = sorted_edges(surface.triangles);
  for (const EdgeEnds& edge : all.edges) {
    const std::array<std::int32_t, 2> faces = faces_at(sorted, edge);
    surface.edge_faces.push_back(faces);
    if (faces[0] < 0) continue;
    const Vec3 one = rest_normal(surface.triangles, faces[0], rest),
               other = rest_normal(surface.triangles, faces[1], rest),
               along = (rest.row(edge[1]) - rest.row(edge[0])).transpose();
    if (one.dot(other) < least_cosine && one.cross(other).dot(along) > 0)
      surface.sharp_edges.push_back(std::int32_t(surface.edge_faces.size()) - 1);
  }
}

// Finds the points at which the normals of two faces are far apart, and the mean length of edges.
void describe_surface(const Model& model, const Part& part, Work::Surface& surface) {
  const Positions rest = rows_of(part, model.rest);
  const Triangles& triangles = surface.triangles;
  std::vector<std::vector<Vec3>> normals(std::size_t(rest.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      normals[triangles(t, k)].push_back(rest_normal(triangles, t, rest));
    }
  }
  surface.edge = mean_edge(triangles, rest);
  for (const std::int32_t v : surface.points) {
    const std::vector<Vec3>& at = normals[own_vertex(model, part, v)];
    bool is_sharp = false;
    for (const Vec3& one : at) {
      for (const Vec3& other : at) is_sharp |= one.dot(other) < least_cosine;
    }
    surface.sharp.push_back(is_sharp);
  }
}

}  // namespace

void make_surfaces(const Model& model, const StepInputs& inputs, Work& work) {
  if (work.structure != model.structure) {
    work.surfaces.clear();
    for (const Part& part : model.parts) {
      Work::Surface& surface = work.surfaces.emplace_back();
      surface.triangles = triangles_of(model, part);
      surface.points = points_of(part, surface.triangles);
      describe_surface(model, part, surface);
      for (const std::int32_t v : surface.points) surface.overhang = std::max(surface.overhang, model.overhang_at(v));
      list_edges(model, part, surface);
      if (!part.solid) surface.layer = sheet_layer(surface.edge);
    }
  }
  work.structure = model.structure;
  for (const Meeting& meeting : inputs.meetings) {
    Work::Surface& surface = work.surfaces[meeting.surface];
    const Part& part = model.parts[meeting.surface];
    if (surface.moving == nullptr)
      surface.moving = std::make_unique<MovingSurface>(surface.triangles, rows_of(part, model.rest));
    if (!meeting.is_own()) continue;
    if (!part.solid && surface.own_sheet == nullptr)
      surface.own_sheet =
          std::make_unique<OwnSheet>(*surface.moving, rows_of(part, model.rest), joined_by_seams(model, part));
    if (part.solid && surface.own == nullptr)
      surface.own =
          std::make_unique<OwnSurface>(elements_of(model, part), *surface.moving, rows_of(part, model.rest), part.size);
  }
}

}  // namespace supple
