#include <algorithm>
#include <iterator>

#include "geometry/triangles/editable_surface.h"

namespace supple {

// Lists the places at which the two ends of an edge may become one vertex, the best one first. The list is empty where
// they must not become one.
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

// Tells whether the surface hangs together as before when an edge is collapsed, by the link condition of Dey,
// Edelsbrunner, Guha, Nekhayev 1999, "Topology preserving edge contraction", for an edge inside a patch or along a
// line. In addition, no two lines may become one.
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

}  // namespace supple
