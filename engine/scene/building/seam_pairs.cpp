#include "scene/building/seam_pairs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

#include "base/error.h"
#include "scene/building/assemble.h"

namespace supple {
namespace {

constexpr std::array side_keys = {"side", "onto"};
constexpr double same_share = 1e-9;  // share of a side's length within which two places are one

// Says what is wrong with a side of a seam.
struct SeamFault {
  std::size_t side;
  std::string message;
};

// Holds the edges on the open border of a cloth: from each vertex, the other ends and the lengths at rest [m].
using Border = std::map<std::int32_t, std::vector<std::pair<std::int32_t, double>>>;

Border border_of(const Body& body) {
  const Triangles& triangles = body.cloth.surface.triangles;
  std::map<VertexPair, int> count;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles(t, k), triangles(t, (k + 1) % 3));
      ++count[{low, high}];
    }
  }
  const Positions& rest = body.description.mesh.rest;
  Border border;
  for (const auto& [edge, triangles_there] : count) {
    if (triangles_there != 1) continue;
    const double length = (rest.row(edge[0]) - rest.row(edge[1])).norm();
    border[edge[0]].emplace_back(edge[1], length);
    border[edge[1]].emplace_back(edge[0], length);
  }
  return border;
}

std::string text_of(const Vec3& point) { return fmt::format("[{:g}, {:g}, {:g}]", point.x(), point.y(), point.z()); }

// Returns the border vertex that is nearest to a point, which is relative to the bounding box.
std::int32_t nearest_on_border(const Body& body, const Border& border, const Vec3& point, std::size_t side) {
  constexpr double furthest = 0.1;  // of the cloth's size
  const Bounds box = bounds_of(body.unplaced);
  const Vec3 at = box.lower + point.cwiseProduct(box.extent());
  const auto distance = [&](const auto& entry) { return (body.unplaced.row(entry.first).transpose() - at).norm(); };
  const auto nearest = std::ranges::min_element(border, {}, distance);
  if (nearest == border.end()) throw SeamFault{side, "the cloth has no border"};
  const double scale = scale_of(body), away = scale * distance(*nearest), most = scale * furthest * box.diagonal();
  if (away > most)
    throw SeamFault{side, fmt::format("the point {} is {:.2g} m from the border of the cloth; a tenth of its size, "
                                      "{:.2g} m, is allowed",
                                      text_of(point), away, most)};
  return nearest->first;
}

// Returns the vertices of the shortest way along the border from one vertex to another, without the first (Dijkstra
// 1959); empty where no way leads there.
std::vector<std::int32_t> way_along(const Border& border, std::int32_t from, std::int32_t to) {
  using Reached = std::pair<double, std::int32_t>;
  std::map<std::int32_t, Reached> best = {{from, {0, from}}};  // by vertex: the distance, and the vertex before it
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
  front.emplace(0, from);
  while (!front.empty()) {
    const auto [distance, v] = front.top();
    front.pop();
    if (distance > best.at(v).first) continue;
    for (const auto& [next, length] : border.at(v)) {
      const auto known = best.find(next);
      if (known != best.end() && known->second.first <= distance + length) continue;
      best[next] = {distance + length, v};
      front.emplace(distance + length, next);
    }
  }
  std::vector<std::int32_t> way;
  if (!best.contains(to)) return way;
  for (std::int32_t v = to; v != from; v = best.at(v).second) way.push_back(v);
  std::ranges::reverse(way);
  return way;
}

// Holds the vertices of a side, and how far along it each is, as a share of its length.
struct Side {
  std::vector<std::int32_t> vertex;
  std::vector<double> share;
  double length = 0;  // at rest [m]
};

// Returns a side of a seam, which follows the border from each of its points to the next.
Side side_of(const Body& body, const Border& border, const SeamDef& def, std::size_t number) {
  const std::vector<Vec3>& points = def.sides[number];
  Side side;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::int32_t next = nearest_on_border(body, border, points[p], number);
    if (p == 0) {
      side.vertex.push_back(next);
      continue;
    }
    const std::string both = fmt::format("the points {} and {}", text_of(points[p - 1]), text_of(points[p]));
    if (next == side.vertex.back()) throw SeamFault{number, both + " are nearest to the same vertex of the border"};
    const std::vector<std::int32_t> way = way_along(border, side.vertex.back(), next);
    if (way.empty()) throw SeamFault{number, both + " are on two borders, and no border leads from one to the other"};
    side.vertex.insert(side.vertex.end(), way.begin(), way.end());
  }
  std::vector<std::int32_t> once(side.vertex.begin() + 1, side.vertex.end());  // a ring ends where it begins
  std::ranges::sort(once);
  if (std::ranges::adjacent_find(once) != once.end() || std::ranges::count(side.vertex, side.vertex.front()) > 2)
    throw SeamFault{number, "it goes along the same border twice: its points must follow one another"};
  for (std::size_t i = 0; i < side.vertex.size(); ++i) {
    const Positions& rest = body.description.mesh.rest;
    if (i > 0) side.length += (rest.row(side.vertex[i]) - rest.row(side.vertex[i - 1])).norm();
    side.share.push_back(side.length);
  }
  for (double& share : side.share) share /= side.length;
  return side;
}

// Joins a vertex with the place at a share of the other side's length.
SeamPair joined(std::int32_t vertex, double share, const Side& other) {
  const auto after = std::ranges::lower_bound(other.share, share - same_share);
  const auto i = std::clamp<std::ptrdiff_t>(after - other.share.begin(), 1, std::ssize(other.share) - 1);
  const double from = other.share[std::size_t(i) - 1], to = other.share[std::size_t(i)];
  double along = std::clamp((share - from) / (to - from), 0.0, 1.0);
  if (share - from < same_share) along = 0;
  if (to - share < same_share) along = 1;
  return {{vertex, other.vertex[std::size_t(i) - 1], other.vertex[std::size_t(i)]}, {1, along - 1, -along}};
}

// Joins the places of two sides. Where both have the same vertex at the same share, as at the tip of a dart, there is
// nothing to join.
std::vector<SeamPair> pairs_of(const std::array<Side, 2>& sides) {
  const bool first_has_more = sides[0].vertex.size() >= sides[1].vertex.size();
  const Side &more = sides[first_has_more ? 0 : 1], &fewer = sides[first_has_more ? 1 : 0];
  std::vector<SeamPair> pairs;
  for (std::size_t i = 0; i < more.vertex.size(); ++i) {
    SeamPair pair = joined(more.vertex[i], more.share[i], fewer);
    const bool is_itself = (pair.vertex[1] == pair.vertex[0] && pair.factor[1] == -1) ||
                           (pair.vertex[2] == pair.vertex[0] && pair.factor[2] == -1);
    if (is_itself) continue;
    if (std::ranges::find(fewer.vertex, more.vertex[i]) != fewer.vertex.end())
      throw SeamFault{1, "it goes along the same border as the other side: they may have their ends in common"};
    pairs.push_back(pair);
  }
  return pairs;
}

void add_seam(Body& body, const Border& border, const SeamDef& def, const Positions& start) {
  const std::array<Side, 2> sides = {side_of(body, border, def, 0), side_of(body, border, def, 1)};
  std::vector<SeamPair> pairs = pairs_of(sides);
  if (pairs.empty()) throw SeamFault{1, "it is the same stretch of border as the other side"};
  Body::Seam seam{{sides[0].length, sides[1].length}, pairs.size(), 0};
  for (SeamPair& pair : pairs) {
    pair.gap = pair.apart(start.data());
    seam.widest = std::max(seam.widest, pair.gap.norm());
    body.description.seams.push_back(pair);
  }
  body.seams.push_back(seam);
}

std::string text_of_seams(const Body& body) {
  std::size_t pairs = 0;
  double widest = 0;
  for (const Body::Seam& seam : body.seams) {
    pairs += seam.pairs;
    widest = std::max(widest, seam.widest);
  }
  const std::size_t seams = body.seams.size();
  return fmt::format(
      "{} seam{} join{} {} pairs of places on its border, which are up to {:.2g} m apart at the start and "
      "meet after {:g} s",
      seams, seams == 1 ? "" : "s", seams == 1 ? "s" : "", pairs, widest, body.def.cloth->seam_time);
}

}  // namespace

void add_seams(Body& body, std::vector<Problem>& problems) {
  if (!body.def.cloth || body.def.cloth->seams.empty()) return;
  const Border border = border_of(body);
  const Positions start = scene_start(body);
  const std::size_t known = problems.size();
  for (const SeamDef& def : body.def.cloth->seams) {
    try {
      add_seam(body, border, def, start);
    } catch (const SeamFault& fault) {
      problems.push_back({def.places[fault.side], fmt::format("{} of a seam of body '{}': {}", side_keys[fault.side],
                                                              body.def.name, fault.message)});
    }
  }
  if (problems.size() == known) body.notes.push_back(text_of_seams(body));
}

std::string uneven_seam_text(const Body& body, std::size_t number) {
  const auto [one, other] = body.seams[number].length;
  const double longer = std::max(one, other), shorter = std::min(one, other);
  if (longer <= 1.1 * shorter) return {};
  return fmt::format("a seam of body '{}' joins {:.3g} m of border with {:.3g} m: the longer side gathers",
                     body.def.name, longer, shorter);
}

}  // namespace supple
