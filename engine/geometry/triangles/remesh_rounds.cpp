#include "geometry/triangles/remesh_rounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace supple {
namespace {

// Describes an edge by its vertices and by the length that it had when it was listed. Edges are ordered by this length,
// and equally long ones by their vertices.
struct ListedEdge {
  double length;
  std::int32_t low, high;

  ListedEdge(const EditableSurface& surface, std::int32_t a, std::int32_t b)
      : length(surface.length(std::min(a, b), std::max(a, b))), low(std::min(a, b)), high(std::max(a, b)) {}
  bool is_current(const EditableSurface& surface, std::vector<std::int32_t>& found) const {
    surface.triangles_at(low, high, found);
    return !found.empty() && surface.length(low, high) == length;
  }
};
struct ShorterFirst {
  bool operator()(const ListedEdge& a, const ListedEdge& b) const {  // whether b comes before a
    return std::tie(a.length, a.low, a.high) > std::tie(b.length, b.low, b.high);
  }
};
struct LongerFirst {
  bool operator()(const ListedEdge& a, const ListedEdge& b) const {
    return std::tie(a.length, b.low, b.high) < std::tie(b.length, a.low, a.high);
  }
};

// Lists the edges that fulfil a condition, each as often as it has triangles.
template <class Condition>
std::vector<ListedEdge> edges_where(const EditableSurface& surface, const Condition& condition) {
  std::vector<ListedEdge> edges;
  for (const EditableSurface::Triangle& t : surface.triangles()) {
    if (t.is_gone()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const ListedEdge edge(surface, t.corners[k], t.corners[(k + 1) % 3]);
      if (condition(edge)) edges.push_back(edge);
    }
  }
  return edges;
}

}  // namespace

void split_long_edges(EditableSurface& surface, double longest) {
  std::priority_queue queue(LongerFirst(),
                            edges_where(surface, [&](const ListedEdge& edge) { return edge.length > longest; }));
  std::vector<std::int32_t> near;
  while (!queue.empty()) {
    const ListedEdge edge = queue.top();
    queue.pop();
    if (!edge.is_current(surface, near)) continue;
    const std::optional<std::int32_t> middle = surface.split(edge.low, edge.high);
    if (!middle) continue;
    surface.neighbours(*middle, near);
    for (const std::int32_t v : near) {
      const ListedEdge part(surface, *middle, v);
      if (part.length > longest) queue.push(part);
    }
  }
}

void collapse_short_edges(EditableSurface& surface, double shortest, double longest) {
  std::priority_queue queue(ShorterFirst(),
                            edges_where(surface, [&](const ListedEdge& edge) { return edge.length < shortest; }));
  std::vector<std::int32_t> near;
  double last_length = -1;
  std::array<std::int32_t, 2> last{-1, -1};
  while (!queue.empty()) {
    const ListedEdge edge = queue.top();
    queue.pop();
    // The queue lists an edge twice in a row where two triangles have it.
    if (edge.length == last_length && last == std::array{edge.low, edge.high}) continue;
    last_length = edge.length;
    last = {edge.low, edge.high};
    if (!edge.is_current(surface, near)) continue;
    const std::optional<std::int32_t> kept = surface.collapse(edge.low, edge.high, longest);
    if (!kept) continue;
    surface.neighbours(*kept, near);
    for (const std::int32_t v : near) {
      const ListedEdge changed(surface, *kept, v);
      if (changed.length < shortest) queue.push(changed);
    }
  }
}

namespace {

using EdgePair = EditableSurface::Pair;

// Flips the pairs that are wanted until there are none. It visits the triangles a few times only, because by rounding a
// pair could be flipped to and fro for ever. After the first visit, only triangles around the flips of the visit before
// are looked at.
template <class Wanted>
void flip_where(EditableSurface& surface, const Wanted& wanted) {
  constexpr int visits = 8;
  const std::size_t count = surface.triangles().size();
  std::vector<char> now(count, 1), next(count, 0);
  for (int visit = 0; visit < visits; ++visit) {
    bool flipped = false;
    for (std::size_t t = 0; t < count; ++t) {
      for (int side = 0; side < 3 && now[t] && !surface.triangles()[t].is_gone(); ++side) {
        const std::optional<EdgePair> pair = surface.pair_at(std::int32_t(t), side);
        if (!pair || !wanted(*pair) || !surface.flip(*pair)) continue;
        flipped = true;
        for (const std::int32_t v : {pair->a, pair->b, pair->c, pair->d})
          for (const std::int32_t near : surface.around(v)) next[std::size_t(near)] = 1;
      }
    }
    if (!flipped) return;
    now.swap(next);
    std::ranges::fill(next, 0);
  }
}

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double area = ab.cross(bc).norm();
  return std::min({std::atan2(area, -ab.dot(ca)), std::atan2(area, -bc.dot(ab)), std::atan2(area, -ca.dot(bc))});
}

}  // namespace

void flip_toward_regular(EditableSurface& surface, const std::vector<double>& wanted) {
  std::vector<std::int32_t> near;
  const auto excess = [&](std::int32_t v) {
    const EditableSurface::Vertex& vertex = surface.vertex(v);
    const auto count = double(surface.around(v).size());
    if (vertex.corner >= 0) return count - wanted[std::size_t(vertex.corner)];
    if (vertex.line < 0) return count - 6;
    std::size_t on_line = 0;  // triangle sides on the line, two for each sheet
    for (const std::int32_t t : surface.around(v)) {
      const EditableSurface::Triangle& own = surface.triangle(t);
      const auto k = std::size_t(own.place_of(v));
      on_line += (own.lines[k] >= 0 ? 1u : 0u) + (own.lines[(k + 2) % 3] >= 0 ? 1u : 0u);
    }
    return count - 1.5 * double(on_line);
  };
  flip_where(surface, [&](const EdgePair& pair) {
    const double a = excess(pair.a), b = excess(pair.b), c = excess(pair.c), d = excess(pair.d);
    // The sum of the squares of a - 1, b - 1, c + 1 and d + 1 must be less than that of a, b, c and d.
    return a + b - c - d > 2;
  });
}

void flip_toward_wide_angles(EditableSurface& surface) {
  flip_where(surface, [&](const EdgePair& pair) {
    const Vec3 &a = surface.vertex(pair.a).x, &b = surface.vertex(pair.b).x, &c = surface.vertex(pair.c).x,
               &d = surface.vertex(pair.d).x;
    const double now = std::min(smallest_angle(a, b, c), smallest_angle(b, a, d));
    const double flipped = std::min(smallest_angle(c, d, b), smallest_angle(d, c, a));
    return flipped > now + 1e-6;
  });
}

namespace {

using MovingVertex = EditableSurface::Vertex;

// Moves a vertex by all of a way, or else by half, a quarter or none of it. place: returns the vertex after a share of
// the way.
template <class Place>
void move_toward(EditableSurface& surface, std::int32_t v, const Place& place) {
  for (const double share : {1.0, 0.5, 0.25, 0.0})
    if (surface.move(v, place(share))) return;
}

void relax_on_line(EditableSurface& surface, std::int32_t v) {
  const MovingVertex now = surface.vertex(v);
  double low = infinity, high = -infinity;  // places of the neighbours on the line, along it [m]
  for (const std::int32_t t : surface.around(v)) {
    const EditableSurface::Triangle& own = surface.triangle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = own.corners[k], b = own.corners[(k + 1) % 3];
      if (own.lines[k] != now.line || (a != v && b != v)) continue;
      const double other = surface.along(now.line, a == v ? b : a);
      low = std::min(low, other);
      high = std::max(high, other);
    }
  }
  const double middle = 0.5 * (low + high);
  move_toward(surface, v,
              [&](double share) { return surface.on_line(now.line, (1 - share) * now.along + share * middle); });
}

void relax_in_patch(EditableSurface& surface, const PatchProjection& projection, std::int32_t v) {
  const MovingVertex now = surface.vertex(v);
  Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
  double weights = 0;
  // Triangles weigh by their areas, so that vertices go where triangles are large (Botsch and Kobbelt, equation 6).
  for (const std::int32_t t : surface.around(v)) {
    const auto x = [&](std::size_t k) -> const Vec3& { return surface.vertex(surface.triangle(t).corners[k]).x; };
    const Vec3 area = (x(1) - x(0)).cross(x(2) - x(0));
    const double size = area.norm();
    normal += area;
    sum += size / 3 * (x(0) + x(1) + x(2));
    weights += size;
  }
  const double length = normal.norm();
  if (!(weights > 0) || !(length > 0)) return;
  normal /= length;
  Vec3 step = sum / weights - now.x;
  step -= step.dot(normal) * normal;
  const std::int32_t patch = surface.triangle(surface.around(v)[0]).patch;
  move_toward(surface, v, [&](double share) {
    const PatchProjection::Place place = projection.closest(now.x + share * step, patch, normal, now.near);
    MovingVertex to = now;
    to.x = place.point;
    to.near = place.triangle;
    return to;
  });
}

}  // namespace

void relax(EditableSurface& surface, const PatchProjection& projection) {
  for (std::int32_t v = 0; v < std::int32_t(surface.vertices().size()); ++v) {
    if (surface.around(v).empty() || surface.vertex(v).corner >= 0) continue;
    if (surface.vertex(v).line >= 0) {
      relax_on_line(surface, v);
    } else {
      relax_in_patch(surface, projection, v);
    }
  }
}

}  // namespace supple
