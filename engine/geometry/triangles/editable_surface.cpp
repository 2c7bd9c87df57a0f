#include "geometry/triangles/editable_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple {
namespace {

using EditableTriangle = EditableSurface::Triangle;

// Describes a triangle by its area vector [m^2] and the sum of its squared sides [m^2].
struct TriangleForm {
  Vec3 area;
  double squares;

  TriangleForm(const Vec3& a, const Vec3& b, const Vec3& c)
      : area(0.5 * (b - a).cross(c - a)),
        squares((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) {}

  // Says how good the triangle is on a surface with this unit normal: 1 for one with equal sides, or the cosine of its
  // tilt over 4 if that is less; negative where it is turned over.
  double score(const Vec3& normal) const {
    const double facing = area.dot(normal), size = area.norm();
    if (!(size > 0)) return 0;
    return std::min(4 * std::sqrt(3.0) * facing / squares, facing / (4 * size));
  }
};

constexpr double good_enough = 0.1;  // a worse score is allowed only where it is an improvement

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

EditableSurface::EditableSurface(const TriMesh& mesh, const SurfaceFeatures& features)
    : mesh_(mesh),
      features_(features),
      vertices_(std::size_t(mesh.points.rows())),
      triangles_(std::size_t(mesh.triangles.rows())),
      around_(vertices_.size()) {
  for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v].x = mesh.points.row(Eigen::Index(v));
  for (std::size_t l = 0; l < features.lines.size(); ++l) {
    const FeatureLine& line = features.lines[l];
    for (std::size_t i = 1; i + 1 < line.vertices.size(); ++i) {
      Vertex& vertex = vertices_[std::size_t(line.vertices[i])];
      vertex.line = std::int32_t(l);
      vertex.along = line.along[i];
    }
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t v = mesh.triangles(Eigen::Index(t), Eigen::Index(k));
      triangles_[t].corners[k] = v;
      around_[std::size_t(v)].push_back(std::int32_t(t));
      if (features.is_corner[std::size_t(v)]) vertices_[std::size_t(v)].corner = v;
      vertices_[std::size_t(v)].near = std::int32_t(t);
    }
    triangles_[t].lines = features.line_of[t];
    triangles_[t].patch = features.patch[t];
  }
}

void EditableSurface::triangles_at(std::int32_t a, std::int32_t b, std::vector<std::int32_t>& found) const {
  found.clear();
  for (const std::int32_t t : around(a))
    if (std::ranges::find(triangle(t).corners, b) != triangle(t).corners.end()) found.push_back(t);
}

void EditableSurface::neighbours(std::int32_t vertex, std::vector<std::int32_t>& found) const {
  found.clear();
  for (const std::int32_t t : around(vertex)) {
    for (const std::int32_t v : triangle(t).corners)
      if (v != vertex) found.push_back(v);
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

std::int32_t EditableSurface::line_between(std::int32_t a, std::int32_t b, std::int32_t t) const {
  return triangle(t).lines[std::size_t(triangle(t).side_of(a, b))];
}

double EditableSurface::along(std::int32_t line, std::int32_t v) const {
  if (vertex(v).corner < 0) return vertex(v).along;
  const FeatureLine& own = features_.lines[std::size_t(line)];
  return own.vertices.front() == vertex(v).corner ? 0 : own.length();
}

EditableSurface::Vertex EditableSurface::on_line(std::int32_t line, double distance) const {
  Vertex result;
  result.x = point_of(features_.lines[std::size_t(line)], distance, mesh_.points);
  result.line = line;
  result.along = distance;
  return result;
}

EditableSurface::Vertex EditableSurface::middle(std::int32_t a, std::int32_t b, std::int32_t line) const {
  if (line >= 0) return on_line(line, 0.5 * (along(line, a) + along(line, b)));
  Vertex result;
  result.x = 0.5 * (vertex(a).x + vertex(b).x);
  result.near = vertex(a).is_free() ? vertex(a).near : vertex(b).near;
  return result;
}

std::optional<std::int32_t> EditableSurface::split(std::int32_t a, std::int32_t b) {
  std::vector<std::int32_t> both;
  triangles_at(a, b, both);
  const std::int32_t line = line_between(a, b, both[0]);
  const Vertex between = middle(a, b, line);
  // The middle of a free edge turns nothing over; that of a line's part can lie beside the edge.
  const bool is_straight = (between.x - 0.5 * (vertex(a).x + vertex(b).x)).norm() <= 1e-9 * length(a, b);
  for (const std::int32_t t : both) {
    if (is_straight) break;
    const auto area = [&](std::int32_t moved) {
      const auto corner = [&](int k) -> Vec3 {
        const std::int32_t v = triangle(t).corners[std::size_t(k)];
        return v == moved ? between.x : vertex(v).x;
      };
      return TriangleForm(corner(0), corner(1), corner(2)).area;
    };
    if (!(area(a).dot(area(-1)) > 0 && area(b).dot(area(-1)) > 0)) return std::nullopt;
  }
  const auto v = std::int32_t(vertices_.size());
  vertices_.push_back(between);
  around_.emplace_back();
  for (const std::int32_t t : both) halve(t, a, b, v);
  return v;
}

void EditableSurface::halve(std::int32_t t, std::int32_t a, std::int32_t b, std::int32_t middle) {
  const auto half = std::int32_t(triangles_.size());
  Triangle other = triangle(t);  // keeps b, and the old triangle keeps a
  Triangle& own = tri(t);
  const std::int32_t c = own.corners[0] + own.corners[1] + own.corners[2] - a - b;
  own.lines[std::size_t(own.side_of(b, c))] = -1;
  other.lines[std::size_t(other.side_of(a, c))] = -1;
  own.corners[std::size_t(own.place_of(b))] = middle;
  other.corners[std::size_t(other.place_of(a))] = middle;
  triangles_.push_back(other);
  drop(b, t);
  around_[std::size_t(b)].push_back(half);
  around_[std::size_t(c)].push_back(half);
  for (const std::int32_t now : {t, half}) around_[std::size_t(middle)].push_back(now);
}

// Compares the triangles of a ring in which a and b go to one place, without those that have both, with how they are.
// The normal that they should have is that of all triangles of their patch in the ring.
bool EditableSurface::keeps_sides(const std::vector<std::int32_t>& ring, std::int32_t a, std::int32_t b,
                                  const Vec3& to) const {
  double before = 1, after = 1;
  std::int32_t patch = -1;
  Vec3 normal = Vec3::Zero();
  for (const std::int32_t t : ring) {
    const auto form = [&](const Triangle& of, bool moved) {
      const auto corner = [&](std::size_t k) -> const Vec3& {
        const std::int32_t v = of.corners[k];
        return moved && (v == a || v == b) ? to : vertex(v).x;
      };
      return TriangleForm(corner(0), corner(1), corner(2));
    };
    if (triangle(t).patch != patch) {
      patch = triangle(t).patch;
      normal.setZero();
      for (const std::int32_t other : ring)
        if (triangle(other).patch == patch) normal += form(triangle(other), false).area;
      normal = unit_or_zero(normal);
    }
    before = std::min(before, form(triangle(t), false).score(normal));
    const auto has = [&](std::int32_t v) {
      return std::ranges::find(triangle(t).corners, v) != triangle(t).corners.end();
    };
    if (a == b || !(has(a) && has(b))) after = std::min(after, form(triangle(t), true).score(normal));
  }
  return after > std::min(good_enough, before);
}

// Lists where the two ends of an edge may become one vertex, the best place first; none: they must not.
std::vector<EditableSurface::Vertex> EditableSurface::merged_places(std::int32_t a, std::int32_t b,
                                                                    std::int32_t line) const {
  const Vertex &one = vertex(a), &other = vertex(b);
  if (one.is_free() && other.is_free()) return {middle(a, b, -1), one, other};
  if (one.is_free()) return {other};
  if (other.is_free()) return {one};
  if (line < 0 || (one.corner >= 0 && other.corner >= 0)) return {};
  if (one.corner >= 0) return {one};
  if (other.corner >= 0) return {other};
  return {middle(a, b, line), one, other};
}

// Tells whether the surface hangs together as before when an edge is collapsed: the link condition of Dey,
// Edelsbrunner, Guha, Nekhayev 1999, "Topology preserving edge contraction", for an edge inside a patch or along a
// line. Beyond it, no two lines may become one.
bool EditableSurface::keeps_topology(std::int32_t a, std::int32_t b, const std::vector<std::int32_t>& between) const {
  std::vector<std::int32_t> of_a, of_b, common, opposite;
  neighbours(a, of_a);
  neighbours(b, of_b);
  std::ranges::set_intersection(of_a, of_b, std::back_inserter(common));
  for (const std::int32_t t : between) {
    const Triangle& own = triangle(t);
    const std::int32_t c = own.corners[0] + own.corners[1] + own.corners[2] - a - b;
    if (line_between(a, c, t) >= 0 && line_between(b, c, t) >= 0) return false;
    opposite.push_back(c);
  }
  std::ranges::sort(opposite);
  if (common != opposite) return false;
  for (const std::int32_t t : around(b)) {  // no triangle of b may become one that a has
    if (std::ranges::find(between, t) != between.end()) continue;
    std::size_t shared = 0;
    for (const std::int32_t v : triangle(t).corners) shared += std::ranges::binary_search(common, v) ? 1 : 0;
    if (shared < 2) continue;
    for (const std::int32_t other : around(a)) {
      std::size_t same = 0;
      for (const std::int32_t v : triangle(t).corners)
        same += v != b && std::ranges::find(triangle(other).corners, v) != triangle(other).corners.end() ? 1 : 0;
      if (same == 2) return false;
    }
  }
  return true;
}

bool EditableSurface::may_merge(std::int32_t a, std::int32_t b, const Vec3& to, double longest) const {
  std::vector<std::int32_t> near, ring = around(a);
  for (const std::int32_t v : {a, b}) {
    neighbours(v, near);
    for (const std::int32_t other : near)
      if (other != a && other != b && !((vertex(other).x - to).norm() <= longest)) return false;
  }
  ring.insert(ring.end(), around(b).begin(), around(b).end());
  std::ranges::sort(ring, {}, [&](std::int32_t t) { return std::pair(triangle(t).patch, t); });
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return keeps_sides(ring, a, b, to);
}

std::optional<std::int32_t> EditableSurface::collapse(std::int32_t a, std::int32_t b, double longest) {
  std::vector<std::int32_t> between;
  triangles_at(a, b, between);
  const std::vector<Vertex> places = merged_places(a, b, line_between(a, b, between[0]));
  if (places.empty() || !keeps_topology(a, b, between)) return std::nullopt;
  for (const Vertex& place : places) {
    if (!may_merge(a, b, place.x, longest)) continue;
    merge(a, b, between);
    vertices_[std::size_t(a)] = place;
    return a;
  }
  return std::nullopt;
}

void EditableSurface::merge(std::int32_t kept, std::int32_t gone, const std::vector<std::int32_t>& between) {
  std::vector<std::array<std::int32_t, 2>> rims;  // the far corners, and the lines that run to them
  for (const std::int32_t t : between) {
    const std::array<std::int32_t, 3> corners = triangle(t).corners;
    const std::int32_t c = corners[0] + corners[1] + corners[2] - kept - gone;
    rims.push_back({c, std::max(line_between(kept, c, t), line_between(gone, c, t))});
    for (const std::int32_t v : corners) drop(v, t);
    tri(t).corners = {-1, -1, -1};
  }
  for (const std::int32_t t : around(gone)) {
    tri(t).corners[std::size_t(triangle(t).place_of(gone))] = kept;
    around_[std::size_t(kept)].push_back(t);
  }
  around_[std::size_t(gone)].clear();
  std::vector<std::int32_t> at_rim;
  for (const auto& [c, line] : rims) {
    if (line < 0) continue;
    triangles_at(kept, c, at_rim);
    for (const std::int32_t t : at_rim) tri(t).lines[std::size_t(triangle(t).side_of(kept, c))] = line;
  }
}

std::optional<EditableSurface::Pair> EditableSurface::pair_at(std::int32_t t, int side) const {
  const Triangle& own = triangle(t);
  if (own.lines[std::size_t(side)] >= 0) return std::nullopt;
  const std::int32_t a = own.corners[std::size_t(side)], b = own.corners[std::size_t((side + 1) % 3)];
  if (a > b) return std::nullopt;  // the other triangle runs from b to a
  for (const std::int32_t other : around(a)) {
    const EditableTriangle& far = triangle(other);
    if (other == t || std::ranges::find(far.corners, b) == far.corners.end()) continue;
    return Pair{t,
                other,
                a,
                b,
                own.corners[std::size_t((side + 2) % 3)],
                far.corners[0] + far.corners[1] + far.corners[2] - a - b};
  }
  return std::nullopt;
}

bool EditableSurface::flip(const Pair& pair) {
  const auto& [first, second, a, b, c, d] = pair;
  if (c == d) return false;
  for (const std::int32_t t : around(c))
    if (std::ranges::find(triangle(t).corners, d) != triangle(t).corners.end()) return false;
  const Vec3 &xa = vertex(a).x, &xb = vertex(b).x, &xc = vertex(c).x, &xd = vertex(d).x;
  const TriangleForm old_one(xa, xb, xc), old_other(xb, xa, xd), one(xc, xd, xb), other(xd, xc, xa);
  const Vec3 normal = unit_or_zero(old_one.area + old_other.area);
  const double before = std::min(old_one.score(normal), old_other.score(normal));
  if (!(std::min(one.score(normal), other.score(normal)) > std::min(good_enough, before))) return false;
  // An edge along which the surface bends must not be replaced by one at which it bends more.
  constexpr double flat = 0.9;  // the cosine of 26 degrees
  const double bend = unit_or_zero(one.area).dot(unit_or_zero(other.area));
  const double old_bend = unit_or_zero(old_one.area).dot(unit_or_zero(old_other.area));
  if (bend < flat && bend < old_bend && before > 0.01) return false;
  const std::int32_t bc = line_between(b, c, first), ca = line_between(c, a, first);
  const std::int32_t ad = line_between(a, d, second), db = line_between(d, b, second);
  const std::int32_t patch = triangle(first).patch;
  tri(first) = {{c, d, b}, {-1, db, bc}, patch};
  tri(second) = {{d, c, a}, {-1, ca, ad}, patch};
  drop(a, first);
  drop(b, second);
  around_[std::size_t(c)].push_back(second);
  around_[std::size_t(d)].push_back(first);
  return true;
}

bool EditableSurface::move(std::int32_t v, const Vertex& to) {
  std::vector<std::int32_t> ring = around(v);
  if (!vertex(v).is_free())
    std::ranges::sort(ring, {}, [&](std::int32_t t) { return std::pair(triangle(t).patch, t); });
  if (!keeps_sides(ring, v, v, to.x)) return false;
  vertices_[std::size_t(v)] = to;
  return true;
}

void EditableSurface::drop(std::int32_t vertex, std::int32_t triangle) {
  std::erase(around_[std::size_t(vertex)], triangle);
}

}  // namespace supple
