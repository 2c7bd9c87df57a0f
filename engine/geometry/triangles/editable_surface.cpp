#include "geometry/triangles/editable_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/triangles/triangle_form.h"

namespace supple {
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

// Tells whether the triangles of a ring stay good enough when the vertices a and b go to one place: the worst score
// must then be above good_score, or above the worst score before. Where a and b are two vertices, the triangles that
// have both vanish, and do not count then. The ring must list the triangles of each patch one after the other, because
// scores are those on a surface with the normal that the patch has in the ring.
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
  return after > std::min(good_score, before);
}

std::optional<EditableSurface::Pair> EditableSurface::pair_at(std::int32_t t, int side) const {
  const Triangle& own = triangle(t);
  if (own.lines[std::size_t(side)] >= 0) return std::nullopt;
  const std::int32_t a = own.corners[std::size_t(side)], b = own.corners[std::size_t((side + 1) % 3)];
  if (a > b) return std::nullopt;  // the other triangle runs from b to a
  for (const std::int32_t other : around(a)) {
    const Triangle& far = triangle(other);
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
  if (!(std::min(one.score(normal), other.score(normal)) > std::min(good_score, before))) return false;
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
