// Implements closed_surface of surface_file.h, one function for each step. Triangles keep the number that they had in
// the file, for messages.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "geometry/surface_file.h"
#include "geometry/triangle_solid.h"

namespace supple {
namespace {

constexpr double largest_hole_share = 0.02;

struct Numbered {
  TriMesh mesh;
  std::vector<Eigen::Index> number;  // the number of each triangle in the file, from 1
};

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

Vec3 corner(const TriMesh& mesh, Eigen::Index t, int k) { return mesh.points.row(mesh.triangles(t, k)); }

Vec3 area_vector(const TriMesh& mesh, Eigen::Index t) {
  return 0.5 * (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
}

std::string place(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z()); }

// Gives "triangle 17 at (x, y, z)".
std::string triangle(const Numbered& surface, Eigen::Index t) {
  const Vec3 middle = (corner(surface.mesh, t, 0) + corner(surface.mesh, t, 1) + corner(surface.mesh, t, 2)) / 3;
  return fmt::format("triangle {} at {}", surface.number[at(t)], place(middle));
}

void check_numbers(const TriMesh& raw, const std::string& name) {
  if (raw.triangles.rows() == 0) throw InputError(name, "has no triangles");
  for (Eigen::Index t = 0; t < raw.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = raw.triangles(t, k);
      if (v < 0 || v >= raw.points.rows()) {
        throw InputError(name, fmt::format("triangle {} names vertex {}, but there are {} (counted from 0)", t + 1, v,
                                           raw.points.rows()));
      }
      const Vec3 p = raw.points.row(v);
      if (!p.allFinite())
        throw InputError(name, fmt::format("vertex {} of triangle {} is not finite: {}", k + 1, t + 1, place(p)));
      // Beyond this limit, products of lengths leave the range of doubles.
      if (p.cwiseAbs().maxCoeff() > 1e50)
        throw InputError(name, fmt::format("vertex {} of triangle {} is beyond 1e50: {}", k + 1, t + 1, place(p)));
    }
  }
}

// Merges vertices at the same position, numbers them in the order in which the triangles name them, and drops those
// that no triangle names.
TriMesh merged(const TriMesh& raw) {
  std::vector<std::int32_t> order(at(raw.points.rows()));
  std::iota(order.begin(), order.end(), 0);
  const auto position = [&](std::int32_t v) {
    return std::tuple(raw.points(v, 0), raw.points(v, 1), raw.points(v, 2));
  };
  std::erase_if(order, [&](std::int32_t v) { return !raw.points.row(v).allFinite(); });  // no triangle names these
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return std::pair(position(a), a) < std::pair(position(b), b); });
  std::vector<std::int32_t> same(at(raw.points.rows()), -1), compact(same), used;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeats = i > 0 && position(order[i]) == position(order[i - 1]);
    same[at(order[i])] = repeats ? same[at(order[i - 1])] : order[i];
  }
  TriMesh mesh;
  mesh.triangles = raw.triangles;
  for (std::int32_t& v : mesh.triangles.reshaped()) v = same[at(v)];
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      std::int32_t& v = mesh.triangles(t, k);
      std::int32_t& now = compact[at(v)];
      if (now < 0) {
        now = std::int32_t(used.size());
        used.push_back(v);
      }
      v = now;
    }
  }
  mesh.points = raw.points(used, Eigen::all);
  return mesh;
}

Numbered subset(const Numbered& surface, const std::vector<Eigen::Index>& kept) {
  Numbered part{{surface.mesh.points, surface.mesh.triangles(kept, Eigen::all)}, {}};
  for (const Eigen::Index t : kept) part.number.push_back(surface.number[at(t)]);
  return part;
}

Numbered without_flat_triangles(const Numbered& surface, std::vector<std::string>* notes) {
  const TriMesh& mesh = surface.mesh;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (corner(mesh, t, k) - corner(mesh, t, (k + 1) % 3)).squaredNorm());
    if (area_vector(mesh, t).norm() > 1e-15 * longest) kept.push_back(t);  // a smaller area is round-off
  }
  const Eigen::Index dropped = mesh.triangles.rows() - std::ssize(kept);
  if (dropped > 0) notes->push_back(fmt::format("{} triangles without area were left out", dropped));
  return subset(surface, kept);
}

Numbered without_repeated_triangles(const Numbered& surface, std::vector<std::string>* notes) {
  std::vector<std::pair<std::array<std::int32_t, 3>, Eigen::Index>> keys;
  for (Eigen::Index t = 0; t < surface.mesh.triangles.rows(); ++t) {
    std::array<std::int32_t, 3> key;
    for (int k = 0; k < 3; ++k) key[at(k)] = surface.mesh.triangles(t, k);
    std::sort(key.begin(), key.end());
    keys.emplace_back(key, t);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (i == 0 || keys[i].first != keys[i - 1].first) kept.push_back(keys[i].second);
  std::sort(kept.begin(), kept.end());
  const Eigen::Index dropped = surface.mesh.triangles.rows() - std::ssize(kept);
  if (dropped > 0) notes->push_back(fmt::format("{} triangles that repeat others were left out", dropped));
  return subset(surface, kept);
}

// Describes what a triangle has across its edge from corner k to k + 1.
struct Neighbour {
  Eigen::Index triangle = -1;  // -1 means that the edge is open
  bool alike = false;          // whether the neighbour runs through the edge the other way round, as it should
};
using Neighbours = std::vector<std::array<Neighbour, 3>>;

Neighbours neighbours(const Numbered& surface, const std::string& name) {
  struct Side {
    std::int32_t low, high;
    Eigen::Index triangle;
    int k;
    bool upward;
  };
  const Triangles& triangles = surface.mesh.triangles;
  std::vector<Side> sides;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = triangles(t, k), to = triangles(t, (k + 1) % 3);
      sides.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  Neighbours result(at(triangles.rows()));
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    if (i + 2 < sides.size() && sides[i + 2].low == a.low && sides[i + 2].high == a.high) {
      throw InputError(name, fmt::format("three triangles or more share an edge, among them {}; an edge may have two",
                                         triangle(surface, sides[i + 2].triangle)));
    }
    result[at(a.triangle)][at(a.k)] = {b.triangle, a.upward != b.upward};
    result[at(b.triangle)][at(b.k)] = {a.triangle, a.upward != b.upward};
  }
  return result;
}

// Holds the triangles that are connected through edges, and what is known of them.
struct Component {
  std::vector<Eigen::Index> triangles;
  double area = 0;    // [m^2]
  double volume = 0;  // signed by the way in which most of its area faces in the file [m^3]
  int sense = 1;      // -1 for a cavity
  Bounds box;
};

// Tells which triangles are flipped so that all triangles of a component have one orientation: that of the larger part
// of its area in the file.
struct Flood {
  std::vector<Component> components;
  std::vector<char> turned;
};

void follow_the_majority(const TriMesh& mesh, Component& component, std::vector<char>& turned) {
  double turned_area = 0;
  for (const Eigen::Index t : component.triangles) {
    const double own = area_vector(mesh, t).norm();
    component.area += own;
    if (turned[at(t)]) turned_area += own;
    for (int k = 0; k < 3; ++k) component.box.include(corner(mesh, t, k));
  }
  if (turned_area > 0.5 * component.area)
    for (const Eigen::Index t : component.triangles) turned[at(t)] ^= 1;
}

Flood flood(const Numbered& surface, const Neighbours& next, const std::string& name) {
  Flood result;
  result.turned.assign(next.size(), 0);
  std::vector<char> reached(next.size(), 0);
  for (Eigen::Index seed = 0; seed < std::ssize(next); ++seed) {
    if (reached[at(seed)]) continue;
    Component component;
    component.triangles.push_back(seed);
    reached[at(seed)] = 1;
    for (std::size_t i = 0; i < component.triangles.size(); ++i) {
      const Eigen::Index t = component.triangles[i];
      for (const Neighbour& other : next[at(t)]) {
        if (other.triangle < 0) continue;
        const char wanted = other.alike ? result.turned[at(t)] : char(1 - result.turned[at(t)]);
        if (!reached[at(other.triangle)]) {
          reached[at(other.triangle)] = 1;
          result.turned[at(other.triangle)] = wanted;
          component.triangles.push_back(other.triangle);
        } else if (result.turned[at(other.triangle)] != wanted) {
          throw InputError(name, fmt::format("the surface is one-sided, like a Moebius strip: no inside at {}",
                                             triangle(surface, other.triangle)));
        }
      }
    }
    std::sort(component.triangles.begin(), component.triangles.end());
    follow_the_majority(surface.mesh, component, result.turned);
    result.components.push_back(std::move(component));
  }
  return result;
}

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
      if (next[at(t)][at(k)].triangle < 0) open.emplace_back(t, k);
  std::vector<std::int32_t> vertices;
  for (const auto& [t, k] : open)
    for (const int end : {k, (k + 1) % 3}) vertices.push_back(mesh.triangles(t, end));
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::size_t> parent(vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t vertex) {
    auto i = std::size_t(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [t, k] : open) parent[root(mesh.triangles(t, k))] = root(mesh.triangles(t, (k + 1) % 3));

  std::vector<Hole> by_root(vertices.size()), result;
  for (const auto& [t, k] : open) {
    Hole& hole = by_root[root(mesh.triangles(t, k))];
    const Vec3 a = corner(mesh, t, k), b = corner(mesh, t, (k + 1) % 3);
    ++hole.edges;
    hole.triangle = t;
    hole.length += (b - a).norm();
    hole.rim_sum += 0.5 * (b - a).norm() * (a + b);
  }
  for (const auto& [t, k] : open) {
    Hole& hole = by_root[root(mesh.triangles(t, k))];
    const Vec3 a = corner(mesh, t, k) - hole.middle(), b = corner(mesh, t, (k + 1) % 3) - hole.middle();
    hole.area += 0.5 * a.cross(b).norm();
  }
  for (const Hole& hole : by_root)
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
    throw InputError(name, fmt::format("the surface is open: holes of {:.3g} % of its area, the largest at {}; up to "
                                       "{:.3g} % are allowed",
                                       100 * share, triangle(surface, largest.triangle), 100 * largest_hole_share));
  }
  if (edges > 0) {
    notes->push_back(fmt::format("{} open edges around {} holes, of up to {:.2g} % of the area: taken as closed", edges,
                                 count, 100 * worst));
  }
}

void turn_over(Triangles& triangles, Eigen::Index t) { std::swap(triangles(t, 1), triangles(t, 2)); }

void measure_volumes(const Numbered& surface, std::vector<Component>& components, const std::string& name) {
  for (Component& component : components) {
    const Vec3 center = component.box.center();
    for (const Eigen::Index t : component.triangles)
      component.volume += area_vector(surface.mesh, t).dot(corner(surface.mesh, t, 0) - center) / 3;
    if (!(std::abs(component.volume) > 1e-12 * component.area * component.box.diagonal()))
      throw InputError(
          name, fmt::format("the surface encloses no volume at {}", triangle(surface, component.triangles.front())));
  }
}

bool encloses(const Bounds& outer, const Bounds& inner) {
  return (outer.lower.array() <= inner.lower.array()).all() && (outer.upper.array() >= inner.upper.array()).all();
}

// Tells whether every corner of `inner` lies within `outer`, by the winding number. The solid is built when it is first
// needed.
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

TriMesh closed_surface(TriMesh raw, const std::string& name, std::vector<std::string>* notes) {
  std::vector<std::string> unwanted;
  if (notes == nullptr) notes = &unwanted;
  check_numbers(raw, name);
  Numbered surface{merged(raw), std::vector<Eigen::Index>(at(raw.triangles.rows()))};
  std::iota(surface.number.begin(), surface.number.end(), 1);
  surface = without_repeated_triangles(without_flat_triangles(surface, notes), notes);
  if (surface.mesh.triangles.rows() == 0) throw InputError(name, "has no triangle with an area");

  const Neighbours next = neighbours(surface, name);
  auto [components, turned] = flood(surface, next, name);
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

}  // namespace supple
