#include "geometry/solids/closed_surface.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "geometry/solids/surface_closing.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

constexpr double largest_hole_share = 0.02;

struct Hole {
  Eigen::Index edges = 0;
  Eigen::Index triangle = -1;  // one of the triangles at its rim
  Vec3 rim_sum = Vec3::Zero();
  double length = 0, area = 0;
  Vec3 middle() const { return length > 0 ? Vec3(rim_sum / length) : rim_sum; }
};

// Finds the holes of a component: its open edges, grouped by the vertices that they share. A hole's area is that of the
// fan of triangles about its middle.
std::vector<Hole> holes(const TriMesh& mesh, const Neighbours& next, const Component& component) {
  std::vector<std::pair<Eigen::Index, int>> open;
  for (const Eigen::Index t : component.triangles)
    for (int k = 0; k < 3; ++k)
      if (next.of[at(t)][at(k)].triangle < 0) open.emplace_back(t, k);
  std::vector<std::int32_t> vertices;
  for (const auto& [t, k] : open)
    for (const int end : {k, (k + 1) % 3}) vertices.push_back(mesh.triangles(t, end));
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  DisjointSets rims(vertices.size());
  const auto number = [&](std::int32_t vertex) {
    return std::size_t(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  };
  for (const auto& [t, k] : open) rims.join(number(mesh.triangles(t, k)), number(mesh.triangles(t, (k + 1) % 3)));

  std::vector<Hole> by_rim(vertices.size()), result;
  for (const auto& [t, k] : open) {
    Hole& hole = by_rim[rims.of(number(mesh.triangles(t, k)))];
    const Vec3 a = corner(mesh, t, k), b = corner(mesh, t, (k + 1) % 3);
    ++hole.edges;
    hole.triangle = t;
    hole.length += (b - a).norm();
    hole.rim_sum += 0.5 * (b - a).norm() * (a + b);
  }
  for (const auto& [t, k] : open) {
    Hole& hole = by_rim[rims.of(number(mesh.triangles(t, k)))];
    const Vec3 a = corner(mesh, t, k) - hole.middle(), b = corner(mesh, t, (k + 1) % 3) - hole.middle();
    hole.area += 0.5 * a.cross(b).norm();
  }
  for (const Hole& hole : by_rim)
    if (hole.edges > 0) result.push_back(hole);
  return result;
}

void check_holes(const Numbered& surface, const Neighbours& next, const std::vector<Component>& components,
                 const std::string& name, std::vector<std::string>* notes) {
  Eigen::Index count = 0, edges = 0;
  double worst = 0;
  for (const Component& component : components) {
    const std::vector<Hole> found = holes(surface.mesh, next, component);
    if (found.empty()) continue;
    double area = 0;
    for (const Hole& hole : found) {
      area += hole.area;
      edges += hole.edges;
    }
    count += std::ssize(found);
    const double share = area / component.area;
    worst = std::max(worst, share);
    if (share <= largest_hole_share) continue;
    const Hole& largest =
        *std::max_element(found.begin(), found.end(), [](const Hole& a, const Hole& b) { return a.area < b.area; });
    throw InputError(name,
                     fmt::format("the surface is open: holes of {:.3g} % of its area, the largest at {}; up to "
                                 "{:.3g} % are allowed",
                                 100 * share, triangle_text(surface, largest.triangle), 100 * largest_hole_share));
  }
  if (edges > 0) {
    notes->push_back(fmt::format("{} open edges around {} holes, of up to {:.2g} % of the area: taken as closed", edges,
                                 count, 100 * worst));
  }
}

void measure_volumes(const Numbered& surface, std::vector<Component>& components, const std::string& name) {
  for (Component& component : components) {
    const Vec3 center = component.box.center();
    for (const Eigen::Index t : component.triangles)
      component.volume += area_vector(surface.mesh, t).dot(corner(surface.mesh, t, 0) - center) / 3;
    if (!(std::abs(component.volume) > 1e-12 * component.area * component.box.diagonal()))
      throw InputError(name, fmt::format("the surface encloses no volume at {}",
                                         triangle_text(surface, component.triangles.front())));
  }
}

bool encloses(const Bounds& outer, const Bounds& inner) {
  return (outer.lower.array() <= inner.lower.array()).all() && (outer.upper.array() >= inner.upper.array()).all();
}

// Tells whether every corner of `inner` lies within `outer`, by the winding number. The solid of `outer` is built when
// it is first needed.
bool encloses(const TriMesh& mesh, const Component& outer, const Component& inner,
              std::vector<TriangleSolid>& solid_of_outer) {
  if (!encloses(outer.box, inner.box)) return false;
  if (solid_of_outer.empty()) {
    TriMesh own{mesh.points, mesh.triangles(outer.triangles, Eigen::all)};
    if (outer.volume < 0) own.triangles.col(1).swap(own.triangles.col(2));
    solid_of_outer.emplace_back(merged(own));
  }
  return std::all_of(inner.triangles.begin(), inner.triangles.end(), [&](Eigen::Index t) {
    for (int k = 0; k < 3; ++k)
      if (!(solid_of_outer.front().winding_number(corner(mesh, t, k)) > 0.5)) return false;
    return true;
  });
}

// Orients every component outward, except for cavities: a component inside another one keeps the opposite orientation
// if it has that in the file.
void decide_senses(const TriMesh& mesh, std::vector<Component>& components) {
  std::vector<std::size_t> order(components.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(components[a].volume) > std::abs(components[b].volume);
  });
  std::vector<std::vector<TriangleSolid>> solids(components.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    Component& inner = components[order[i]];
    for (std::size_t j = i; j-- > 0;) {  // finds the smallest one that holds it
      const Component& outer = components[order[j]];
      if (!encloses(mesh, outer, inner, solids[order[j]])) continue;
      inner.sense = (inner.volume < 0) == (outer.volume < 0) ? outer.sense : -outer.sense;
      break;
    }
  }
}

}  // namespace

TriMesh closed(Numbered surface, const std::string& name, std::vector<std::string>* notes) {
  const Neighbours next = neighbours_of(surface);
  if (next.crowded >= 0) {
    throw InputError(name, fmt::format("three triangles or more share an edge, among them {}; an edge may have two",
                                       triangle_text(surface, next.crowded)));
  }
  auto [components, turned, one_sided] = flood(surface, next);
  if (one_sided >= 0) {
    throw InputError(name, fmt::format("the surface is one-sided, like a Moebius strip: no inside at {}",
                                       triangle_text(surface, one_sided)));
  }
  check_holes(surface, next, components, name, notes);
  Triangles& triangles = surface.mesh.triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    if (turned[at(t)]) turn_over(triangles, t);
  measure_volumes(surface, components, name);
  decide_senses(surface.mesh, components);
  for (const Component& component : components) {
    if ((component.volume < 0) == (component.sense < 0)) continue;
    for (const Eigen::Index t : component.triangles) {
      turn_over(triangles, t);
      turned[at(t)] ^= 1;
    }
  }
  const auto count = std::count(turned.begin(), turned.end(), 1);
  if (count > 0)
    notes->push_back(fmt::format("{} of {} triangles were turned to face outward", count, triangles.rows()));
  return merged(surface.mesh);
}

TriMesh closed_surface(TriMesh raw, const std::string& name, std::vector<std::string>* notes) {
  std::vector<std::string> unwanted;
  if (notes == nullptr) notes = &unwanted;
  return closed(cleaned(raw, name, notes), name, notes);
}

}  // namespace supple
