#include "geometry/triangles/numbered_surface.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {

Vec3 area_vector(const TriMesh& mesh, Eigen::Index t) {
  return 0.5 * (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
}

bool is_flat(const TriMesh& mesh, Eigen::Index t) {
  double longest = 0;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, (corner(mesh, t, k) - corner(mesh, t, (k + 1) % 3)).squaredNorm());
  return !(area_vector(mesh, t).norm() > 1e-15 * longest);
}

std::string place_text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z()); }

void turn_over(Triangles& triangles, Eigen::Index t) { std::swap(triangles(t, 1), triangles(t, 2)); }

std::string triangle_text(const Numbered& surface, Eigen::Index t) {
  const Vec3 middle = (corner(surface.mesh, t, 0) + corner(surface.mesh, t, 1) + corner(surface.mesh, t, 2)) / 3;
  return fmt::format("triangle {} at {}", surface.number[at(t)], place_text(middle));
}

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
        throw InputError(name, fmt::format("vertex {} of triangle {} is not finite: {}", k + 1, t + 1, place_text(p)));
      // Beyond this limit, products of lengths leave the range of doubles.
      if (p.cwiseAbs().maxCoeff() > 1e50)
        throw InputError(name, fmt::format("vertex {} of triangle {} is beyond 1e50: {}", k + 1, t + 1, place_text(p)));
    }
  }
}

namespace {

Numbered without_flat_triangles(const Numbered& surface, std::vector<std::string>* notes) {
  const TriMesh& mesh = surface.mesh;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    if (!is_flat(mesh, t)) kept.push_back(t);
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

}  // namespace

Numbered cleaned(const TriMesh& raw, const std::string& name, std::vector<std::string>* notes) {
  check_numbers(raw, name);
  Numbered surface{merged(raw), std::vector<Eigen::Index>(at(raw.triangles.rows()))};
  std::iota(surface.number.begin(), surface.number.end(), 1);
  surface = without_repeated_triangles(without_flat_triangles(surface, notes), notes);
  if (surface.mesh.triangles.rows() == 0) throw InputError(name, "has no triangle with an area");
  return surface;
}

Neighbours neighbours_of(const Numbered& surface) {
  const std::vector<TriangleEdge> sides = sorted_edges(surface.mesh.triangles);
  Neighbours result;
  result.of.resize(at(surface.mesh.triangles.rows()));
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;) ++end;
    if (end - i > 2 && result.crowded < 0) result.crowded = sides[i + 2].triangle;
    if (end - i != 2) continue;
    const TriangleEdge &a = sides[i], &b = sides[i + 1];
    result.of[at(a.triangle)][at(a.side)] = {b.triangle, a.upward != b.upward};
    result.of[at(b.triangle)][at(b.side)] = {a.triangle, a.upward != b.upward};
  }
  return result;
}

namespace {

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

}  // namespace

Flood flood(const Numbered& surface, const Neighbours& next) {
  Flood result;
  result.turned.assign(next.of.size(), 0);
  std::vector<char> reached(next.of.size(), 0);
  for (Eigen::Index seed = 0; seed < std::ssize(next.of); ++seed) {
    if (reached[at(seed)]) continue;
    Component component;
    component.triangles.push_back(seed);
    reached[at(seed)] = 1;
    for (std::size_t i = 0; i < component.triangles.size(); ++i) {
      const Eigen::Index t = component.triangles[i];
      for (const Neighbour& other : next.of[at(t)]) {
        if (other.triangle < 0) continue;
        const char wanted = other.alike ? result.turned[at(t)] : char(1 - result.turned[at(t)]);
        if (!reached[at(other.triangle)]) {
          reached[at(other.triangle)] = 1;
          result.turned[at(other.triangle)] = wanted;
          component.triangles.push_back(other.triangle);
        } else if (result.turned[at(other.triangle)] != wanted && result.one_sided < 0) {
          result.one_sided = other.triangle;
        }
      }
    }
    std::sort(component.triangles.begin(), component.triangles.end());
    follow_the_majority(surface.mesh, component, result.turned);
    result.components.push_back(std::move(component));
  }
  return result;
}

}  // namespace supple
