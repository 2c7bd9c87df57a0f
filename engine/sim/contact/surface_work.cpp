#include "sim/contact/surface_work.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "geometry/triangles/triangle_edges.h"
#include "sim/contact/sheet_layer.h"
#include "sim/model/element_view.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

using Work = SurfaceWork::Parts;

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

// Lists the edges of a sheet.
void list_edges(const Part& part, Work::Surface& surface) {
  EdgesByTriangle all = edges_by_triangle(surface.triangles);
  for (const EdgeEnds& edge : all.edges)
    surface.edges.push_back({joined_vertex(part, edge[0]), joined_vertex(part, edge[1])});
  surface.edge_begin = std::move(all.begin);
}

// Finds the points at which the normals of two faces are far apart, and the mean length of edges.
void describe_surface(const Model& model, const Part& part, Work::Surface& surface) {
  constexpr double least_cosine = 0.5;
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
      if (part.solid) continue;
      surface.layer = sheet_layer(surface.edge);
      list_edges(part, surface);
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
      surface.own_sheet = std::make_unique<OwnSheet>(*surface.moving, rows_of(part, model.rest));
    if (part.solid && surface.own == nullptr)
      surface.own = std::make_unique<OwnSurface>(elements_of(model, part), surface.triangles, rows_of(part, model.rest),
                                                 part.size);
  }
}

}  // namespace supple
