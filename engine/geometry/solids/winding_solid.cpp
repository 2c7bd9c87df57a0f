#include "geometry/solids/winding_solid.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/error.h"
#include "geometry/solids/sign_grid.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

using VertexNames = std::vector<std::int32_t>;

// Lists the vertices next to each one, in one array: those of v are at [start[v], start[v + 1]).
struct Rings {
  std::vector<std::size_t> start;
  VertexNames next;
};

Rings rings_of(const TriMesh& mesh) {
  Rings rings;
  rings.start.assign(std::size_t(mesh.points.rows()) + 1, 0);
  for (const std::int32_t v : mesh.triangles.reshaped()) ++rings.start[std::size_t(v) + 1];
  for (std::size_t v = 1; v < rings.start.size(); ++v) rings.start[v] += rings.start[v - 1];
  rings.next.resize(rings.start.back());
  std::vector<std::size_t> place(rings.start.begin(), rings.start.end() - 1);
  // On a closed manifold each neighbour of v follows v in exactly one triangle.
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) rings.next[place[std::size_t(mesh.triangles(t, k))]++] = mesh.triangles(t, (k + 1) % 3);
  return rings;
}

// Moves the flagged vertices half way to the middle of their neighbours, `rounds` times.
Positions smoothed(Positions points, const Rings& rings, const std::vector<char>& moves, int rounds) {
  Positions before;
  for (int round = 0; round < rounds; ++round) {
    before = points;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      if (!moves[at(v)]) continue;
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      const std::size_t first = rings.start[at(v)], last = rings.start[at(v) + 1];
      for (std::size_t i = first; i < last; ++i) sum += before.row(rings.next[i]);
      points.row(v) = 0.5 * before.row(v) + 0.5 / double(last - first) * sum;
    }
  }
  return points;
}

Positions vertex_normals(const Positions& points, const Triangles& triangles) {
  Positions normals = Positions::Zero(points.rows(), 3);
  const TriMesh mesh{points, triangles};
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Vec3 own = area_vector(mesh, t);
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += own.transpose();
  }
  return normals;
}

// Flags the vertices of triangles that turned over, or nearly, when vertices were moved away from `plain`. Tells
// whether one of them had no flag yet.
bool free_those_of_turned_triangles(const Positions& plain, TriMesh& boundary, std::vector<char>& free) {
  const TriMesh before{plain, boundary.triangles};
  bool any = false;
  for (Eigen::Index t = 0; t < boundary.triangles.rows(); ++t) {
    const Vec3 own = area_vector(boundary, t), was = area_vector(before, t);
    if (own.dot(was) > 0.1 * own.norm() * was.norm()) continue;
    for (int k = 0; k < 3; ++k) {
      char& flag = free[at(boundary.triangles(t, k))];
      any |= !flag;
      flag = 1;
    }
  }
  return any;
}

// Moves the vertices of the grid's boundary onto the triangles within reach that face the same way. Returns which of
// them found none: those in holes.
std::vector<char> move_onto(const TriangleSoup& soup, double cell, TriMesh& boundary, Threads& threads) {
  const Rings rings = rings_of(boundary);
  const auto count = std::size_t(boundary.points.rows());
  const Positions plain = smoothed(boundary.points, rings, std::vector<char>(count, 1), 4);
  const Positions normals = vertex_normals(plain, boundary.triangles);
  std::vector<char> in_hole(count, 0);
  Positions nearest = plain;
  constexpr Eigen::Index chunk = 1024;
  threads.run(int((boundary.points.rows() + chunk - 1) / chunk), [&](int c) {
    const Eigen::Index end = std::min((c + 1) * chunk, boundary.points.rows());
    for (Eigen::Index v = c * chunk; v < end; ++v) {
      const auto near = soup.closest(plain.row(v).transpose(), 1.5 * cell, normals.row(v).transpose());
      if (near.triangle >= 0) nearest.row(v) = near.point.transpose();
      in_hole[at(v)] = near.triangle < 0;
    }
  });
  std::vector<char> free = in_hole;
  for (int round = 0; round < 8; ++round) {
    boundary.points = nearest;
    for (Eigen::Index v = 0; v < plain.rows(); ++v)
      if (free[at(v)]) boundary.points.row(v) = plain.row(v);
    boundary.points = smoothed(boundary.points, rings, free, 30);
    if (!free_those_of_turned_triangles(plain, boundary, free)) break;
  }
  return in_hole;
}

// Returns a mesh without the vertices that no triangle names. Vertices at the same place stay apart: merging them could
// join what only touches.
TriMesh without_unused_vertices(const TriMesh& mesh) {
  VertexNames name(at(mesh.points.rows()), -1), used;
  TriMesh result{Positions(), mesh.triangles};
  for (std::int32_t& v : result.triangles.reshaped<Eigen::RowMajor>()) {
    if (name[at(v)] < 0) {
      name[at(v)] = std::int32_t(used.size());
      used.push_back(v);
    }
    v = name[at(v)];
  }
  result.points = mesh.points(used, Eigen::all);
  return result;
}

// Leaves out the parts of a closed surface that hold less than a ten-thousandth of the largest part's volume: crumbs
// that the grid makes of parts thinner than its cells.
TriMesh without_crumbs(const TriMesh& boundary) {
  Numbered surface{boundary, std::vector<Eigen::Index>(at(boundary.triangles.rows()), 0)};
  const Flood parts = flood(surface, neighbours_of(surface));
  std::vector<double> volumes;
  for (const Component& part : parts.components) {
    double volume = 0;
    const Vec3 center = part.box.center();
    for (const Eigen::Index t : part.triangles)
      volume += area_vector(boundary, t).dot(corner(boundary, t, 0) - center) / 3;
    volumes.push_back(std::abs(volume));
  }
  const double least = 1e-4 * *std::max_element(volumes.begin(), volumes.end());
  std::vector<Eigen::Index> kept;
  for (std::size_t c = 0; c < volumes.size(); ++c)
    if (volumes[c] >= least)
      kept.insert(kept.end(), parts.components[c].triangles.begin(), parts.components[c].triangles.end());
  std::sort(kept.begin(), kept.end());
  return without_unused_vertices({boundary.points, boundary.triangles(kept, Eigen::all)});
}

// Says what is on a triangle's two sides, by samples half a cell away from it.
enum class Side { surface, turned, hidden, loose };

// Adds the places of a triangle's samples, those in front of it and behind it in turns.
void add_samples(const TriangleSoup& soup, Eigen::Index t, double cell, std::vector<Vec3>& places) {
  const TriMesh& mesh = soup.mesh();
  const Vec3 a = corner(mesh, t, 0), b = corner(mesh, t, 1), c = corner(mesh, t, 2);
  const Vec3 step = 0.5 * cell * soup.normals().row(t).transpose();
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int parts = std::clamp(int(longest / (4 * cell)), 1, 6);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      const double v = (i + 1.0 / 3) / parts, w = (j + 1.0 / 3) / parts;
      const Vec3 p = a + v * (b - a) + w * (c - a);
      places.push_back(p + step);
      places.push_back(p - step);
    }
  }
}

// Returns what is on a triangle's two sides. windings: the winding numbers at its samples, those in front and behind in
// turns.
Side side_of(std::span<const double> windings) {
  int votes[4] = {0, 0, 0, 0};
  for (std::size_t i = 0; i < windings.size(); i += 2) {
    const bool front = windings[i] > 0.5, behind = windings[i + 1] > 0.5;
    ++votes[int(front == behind ? (front ? Side::hidden : Side::loose) : (front ? Side::turned : Side::surface))];
  }
  // A triangle of which any part can be seen is drawn, and faces the way that most of its visible part faces.
  if (votes[0] + votes[1] > 0) return votes[0] >= votes[1] ? Side::surface : Side::turned;
  return votes[int(Side::loose)] > 0 ? Side::loose : Side::hidden;
}

// Cuts triangles in half at their longest edges until these are short, so that a tree's parts become small where they
// are near: long triangles, of which models of machines are made, would have to be summed one by one. The winding
// number stays the same.
TriMesh with_short_edges(const TriMesh& mesh, double longest) {
  constexpr std::size_t most_triangles = 2'000'000;
  std::vector<Vec3> points;
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) points.emplace_back(mesh.points.row(v).transpose());
  std::vector<std::array<std::int32_t, 3>> waiting, done;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
    waiting.push_back({mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)});
  while (!waiting.empty()) {
    const std::array<std::int32_t, 3> triangle = waiting.back();
    waiting.pop_back();
    const auto length = [&](std::size_t k) {
      return (points[at(triangle[(k + 1) % 3])] - points[at(triangle[k])]).squaredNorm();
    };
    std::size_t edge = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (length(k) > length(edge)) edge = k;
    if (length(edge) <= longest * longest || done.size() + waiting.size() > most_triangles) {
      done.push_back(triangle);
      continue;
    }
    const std::int32_t a = triangle[edge], b = triangle[(edge + 1) % 3], c = triangle[(edge + 2) % 3];
    const auto middle = std::int32_t(points.size());
    points.push_back(0.5 * (points[at(a)] + points[at(b)]));
    waiting.push_back({a, middle, c});
    waiting.push_back({middle, b, c});
  }
  TriMesh result{Positions(std::ssize(points), 3), Triangles(std::ssize(done), 3)};
  for (std::size_t v = 0; v < points.size(); ++v) result.points.row(Eigen::Index(v)) = points[v].transpose();
  for (std::size_t t = 0; t < done.size(); ++t)
    result.triangles.row(Eigen::Index(t)) << done[t][0], done[t][1], done[t][2];
  return result;
}

std::vector<Side> sides_of(const TriangleSoup& soup, const TriangleSoup& field, WindingSolid& result,
                           Threads& threads) {
  const Eigen::Index count = soup.mesh().triangles.rows();
  std::vector<Side> sides(at(count), Side::surface);
  constexpr Eigen::Index chunk = 256;
  threads.run(int((count + chunk - 1) / chunk), [&](int c) {
    const Eigen::Index end = std::min((c + 1) * chunk, count);
    std::vector<Vec3> places;
    std::vector<double> windings;
    std::vector<std::size_t> starts;  // of each triangle's samples
    for (Eigen::Index t = c * chunk; t < end; ++t) {
      starts.push_back(places.size());
      add_samples(soup, t, result.cell, places);
    }
    starts.push_back(places.size());
    field.winding_numbers(places, windings);
    const std::span<const double> all(windings);
    for (std::size_t i = 0; i + 1 < starts.size(); ++i)
      sides[at(c * chunk) + i] = side_of(all.subspan(starts[i], starts[i + 1] - starts[i]));
  });
  double area = 0;
  for (Eigen::Index t = 0; t < count; ++t) {
    const double own = area_vector(soup.mesh(), t).norm();
    area += own;
    if (sides[at(t)] == Side::loose) result.loose += own;
    if (sides[at(t)] == Side::hidden) result.hidden += own;
  }
  result.hidden /= area;
  result.loose /= area;
  return sides;
}

// Puts together the triangles that can be seen and those parts of the boundary that close holes.
void make_drawn(const TriangleSoup& soup, const std::vector<Side>& sides, const std::vector<char>& in_hole,
                const TriMesh& boundary, WindingSolid& result) {
  const Eigen::Index first = soup.mesh().points.rows();
  std::vector<std::array<std::int32_t, 3>> drawn;
  double patched = 0, whole = 0;
  for (Eigen::Index t = 0; t < soup.mesh().triangles.rows(); ++t) {
    if (sides[at(t)] == Side::hidden) continue;
    const auto row = soup.mesh().triangles.row(t);
    const bool over = sides[at(t)] == Side::turned;
    result.turned += over ? 1 : 0;
    drawn.push_back({row[0], row[over ? 2 : 1], row[over ? 1 : 2]});
  }
  for (Eigen::Index t = 0; t < boundary.triangles.rows(); ++t) {
    const auto row = boundary.triangles.row(t);
    const double own = area_vector(boundary, t).norm();
    whole += own;
    if (!in_hole[at(row[0])] && !in_hole[at(row[1])] && !in_hole[at(row[2])]) continue;
    patched += own;
    drawn.push_back({row[0] + std::int32_t(first), row[1] + std::int32_t(first), row[2] + std::int32_t(first)});
  }
  result.patched = patched / whole;
  TriMesh both{Positions(first + boundary.points.rows(), 3), Triangles(std::ssize(drawn), 3)};
  both.points << soup.mesh().points, boundary.points;
  for (std::size_t t = 0; t < drawn.size(); ++t)
    both.triangles.row(Eigen::Index(t)) << drawn[t][0], drawn[t][1], drawn[t][2];
  result.drawn = merged(both);
}

}  // namespace

WindingSolid winding_solid(const Numbered& surface, const std::string& name, Threads& threads) {
  WindingSolid result;
  Numbered oriented = surface;
  result.turned = orient_parts(oriented, threads);
  const TriangleSoup soup(oriented.mesh);
  result.cell = suitable_cell(oriented.mesh);
  constexpr double most_loose = 0.65;  // a solid with this much loose around it is a sheet with a bulge
  const std::string thin = fmt::format(
      "encloses no volume: thicken = 0.01 makes a solid of that thickness [m] around its sheets; a body that is cloth "
      "takes them as they are: cloth = {{ surface = \"{}\" }}",
      name);
  constexpr double shortness = 1.0 / 48;  // longest edge for the winding number, over the box's diagonal
  const TriangleSoup field(with_short_edges(oriented.mesh, shortness * bounds_of(oriented.mesh.points).diagonal()));
  const std::vector<Side> sides = sides_of(soup, field, result, threads);
  if (result.loose > most_loose) throw InputError(name, thin);
  SignGrid grid = sampled_signs(field, result.cell, threads);
  make_well_composed(grid);
  TriMesh boundary = boundary_of(grid);
  if (boundary.triangles.rows() == 0) throw InputError(name, thin);
  const std::vector<char> in_hole = move_onto(soup, result.cell, boundary, threads);
  make_drawn(soup, sides, in_hole, boundary, result);
  result.boundary = without_crumbs(boundary);
  return result;
}

}  // namespace supple
