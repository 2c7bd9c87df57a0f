#include "sim/contact/own_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/meshes/mesh.h"
#include "sim/contact/sheet_layer.h"

namespace supple {
namespace {

// Returns the largest motion of one of the first vertices relative to one of the others [m].
template <std::size_t N, std::size_t M>
double motion_beside(const std::array<std::int32_t, N>& one, const std::array<std::int32_t, M>& other,
                     const Positions& q, const Positions& x) {
  double most = 0;
  for (const std::int32_t a : one)
    for (const std::int32_t b : other) most = std::max(most, (x.row(a) - q.row(a) - x.row(b) + q.row(b)).squaredNorm());
  return std::sqrt(most);
}

// Tells whether two things may come nearer to each other than `distance` [m] on their way: they come no nearer than
// (before + after - motion) / 2. before, after: their distances at the start and at the end [m].
bool may_come_nearer(double before, double after, double motion, double distance) {
  return before + after - motion <= 2 * distance;
}

double distance_to_edge(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from, offset = p - from;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp(offset.dot(along) / length, 0.0, 1.0) : 0;
  return (offset - share * along).norm();
}

double distance_to_triangle(const Vec3& p, const OwnSheet::Corners& corners) {
  if (const auto over = OwnSheet::over(corners, p)) return std::abs(over->above);
  return std::min({distance_to_edge(p, corners[0], corners[1]), distance_to_edge(p, corners[1], corners[2]),
                   distance_to_edge(p, corners[2], corners[0])});
}

// Returns the distance of two edges [m]. They are closest where their lines are, if that is on both, or else at an end
// of one.
double distance_of_edges(const TwoEdges& edges) {
  if (edges.meet(0)) return std::abs(edges.volume) / edges.across.norm();
  const Vec3 to = edges.from + edges.way, other_to = edges.other_from + edges.other_way;
  return std::min({distance_to_edge(edges.from, edges.other_from, other_to),
                   distance_to_edge(to, edges.other_from, other_to), distance_to_edge(edges.other_from, edges.from, to),
                   distance_to_edge(other_to, edges.from, to)});
}

// Returns the box around two boxes.
template <class Box>
Box around_both(const Box& a, const Box& b) {
  return {a.lower.min(b.lower), a.upper.max(b.upper)};
}

// Tells whether two boxes are no further from each other than `margin` [m].
template <class Box>
bool are_near(const Box& a, const Box& b, double margin) {
  return (a.lower - b.upper).max(b.lower - a.upper).maxCoeff() <= margin;
}

using Around = std::vector<std::vector<std::int32_t>>;  // by vertex, ascending

// Lists what is around each vertex: the other ends of its edges, the vertices that it is sewn to, what is around those,
// and what the other ends of its edges are sewn to.
Around around_vertices(const std::vector<EdgeEnds>& edges, const std::vector<JoinedVertices>& sewn,
                       Eigen::Index vertices) {
  Around around(static_cast<std::size_t>(vertices));
  for (const auto& [a, b] : edges) {
    around[std::size_t(a)].push_back(b);
    around[std::size_t(b)].push_back(a);
  }
  const Around by_edges = sewn.empty() ? Around{} : around;
  const auto bring = [&](std::int32_t from, std::int32_t to) {
    around[std::size_t(to)].push_back(from);
    for (const std::int32_t beside : by_edges[std::size_t(from)]) {
      around[std::size_t(to)].push_back(beside);
      around[std::size_t(beside)].push_back(to);
    }
  };
  for (const auto& [a, b] : sewn) {
    bring(a, b);
    bring(b, a);
  }
  for (std::vector<std::int32_t>& of_vertex : around) std::sort(of_vertex.begin(), of_vertex.end());
  return around;
}

}  // namespace

OwnSheet::OwnSheet(const MovingSurface& moving, const Positions& rest, const std::vector<JoinedVertices>& sewn)
    : triangles_(moving.triangles()),
      rest_(rest),
      edges_(edges_by_triangle(triangles_)),
      own_begin_(std::size_t(triangles_.rows()) + 1, 0),
      parts_(moving.sheet_parts()),
      layer_(sheet_layer(mean_edge(triangles_, rest))) {
  std::vector<char> is_listed(std::size_t(rest.rows()), 0);
  for (std::int32_t t = 0; t < triangles_.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (!std::exchange(is_listed[std::size_t(triangles_(t, k))], 1)) own_.push_back(triangles_(t, k));
    }
    own_begin_[std::size_t(t) + 1] = std::int32_t(own_.size());
  }
  const Around around = around_vertices(edges_.edges, sewn, rest.rows());
  neighbours_begin_.push_back(0);
  for (const std::vector<std::int32_t>& of_vertex : around) {
    around_.insert(around_.end(), of_vertex.begin(), of_vertex.end());
    neighbours_begin_.push_back(std::int32_t(around_.size()));
  }
}

bool OwnSheet::are_neighbours(std::int32_t a, std::int32_t b) const {
  if (a == b) return true;
  const auto first = around_.begin() + neighbours_begin_[std::size_t(a)],
             end = around_.begin() + neighbours_begin_[std::size_t(a) + 1];
  return std::binary_search(first, end, b);
}

bool OwnSheet::are_beside(std::int32_t vertex, std::int32_t triangle) const {
  return are_neighbours(vertex, triangles_(triangle, 0)) || are_neighbours(vertex, triangles_(triangle, 1)) ||
         are_neighbours(vertex, triangles_(triangle, 2));
}

bool OwnSheet::are_beside(const EdgeEnds& one, const EdgeEnds& other) const {
  return are_neighbours(one[0], other[0]) || are_neighbours(one[0], other[1]) || are_neighbours(one[1], other[0]) ||
         are_neighbours(one[1], other[1]);
}

// Tells whether a vertex and a triangle are not near each other at rest.
bool OwnSheet::is_apart(std::int32_t vertex, std::int32_t triangle) const {
  const std::optional<Over> at_rest = over(corners_of(triangle, rest_), rest_.row(vertex));
  return !at_rest || std::abs(at_rest->above) > 2 * layer_;
}

bool OwnSheet::are_apart(const EdgeEnds& one, const EdgeEnds& other) const {
  const TwoEdges at_rest(one, other, rest_);
  return !at_rest.meet(0) || !at_rest.are_nearer(2 * layer_);
}

OwnSheet::Corners OwnSheet::corners_of(std::int32_t triangle, const Positions& x) const {
  return {x.row(triangles_(triangle, 0)), x.row(triangles_(triangle, 1)), x.row(triangles_(triangle, 2))};
}

std::optional<OwnSheet::Over> OwnSheet::over(const Corners& corners, const Vec3& p) {
  const Vec3 one = corners[1] - corners[0], other = corners[2] - corners[0], offset = p - corners[0];
  const Vec3 area = one.cross(other);
  const double squared = area.squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  const double v = offset.cross(other).dot(area) / squared, w = one.cross(offset).dot(area) / squared;
  if (!(v >= 0 && w >= 0 && v + w <= 1)) return std::nullopt;
  const Vec3 normal = area / std::sqrt(squared);
  return Over{{1 - v - w, v, w}, normal, normal.dot(offset)};
}

double OwnSheet::volume(const Corners& corners, const Vec3& p) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(p - corners[0]);
}

// Finds the boxes in which the vertices move, in the frame that moves by `carried`.
void OwnSheet::find_boxes(const Vec3& carried, const Positions& q, const Positions& x) const {
  boxes_.resize(std::size_t(q.rows()));
  const Eigen::Array4d common(carried[0], carried[1], carried[2], 0);
  for (std::size_t v = 0; v < boxes_.size(); ++v) {
    const double *from = q.data() + 3 * v, *to = x.data() + 3 * v;
    const Eigen::Array4d start(from[0], from[1], from[2], 0), end = Eigen::Array4d(to[0], to[1], to[2], 0) - common;
    boxes_[v] = {start.min(end), start.max(end)};
  }
}

// Calls points(vertex, triangle) and edges(one, other) for pairs that share no vertex and whose boxes may come near,
// until a call returns true; tells whether one did.
template <class Points, class Edges>
bool OwnSheet::any_pair(const MovingSurface& moving, double margin, const Vec3& carried, const Positions& q,
                        const Positions& x, const Points& points, const Edges& edges) const {
  find_boxes(carried, q, x);
  const auto box_of = [&](const auto& vertices) {
    PathBox box = boxes_[std::size_t(vertices[0])];
    for (std::size_t i = 1; i < vertices.size(); ++i) box = around_both(box, boxes_[std::size_t(vertices[i])]);
    return box;
  };
  const auto any_point = [&](std::int32_t of, std::int32_t t) {
    const auto begin = own_begin_[std::size_t(of)], end = own_begin_[std::size_t(of) + 1];
    if (begin == end) return false;
    const std::array corners = {triangles_(t, 0), triangles_(t, 1), triangles_(t, 2)};
    const PathBox box = box_of(corners);
    for (auto i = begin; i < end; ++i) {
      const std::int32_t v = own_[std::size_t(i)];
      if (v == corners[0] || v == corners[1] || v == corners[2]) continue;
      if (are_near(box, boxes_[std::size_t(v)], margin) && points(v, t)) return true;
    }
    return false;
  };
  const auto any_edge = [&](std::int32_t t, std::int32_t u) {
    for (const EdgeEnds& one : edges_.of(t)) {
      const PathBox box = box_of(one);
      for (const EdgeEnds& other : edges_.of(u)) {
        if (one[0] == other[0] || one[0] == other[1] || one[1] == other[0] || one[1] == other[1]) continue;
        if (are_near(box, box_of(other), margin) && edges(one, other)) return true;
      }
    }
    return false;
  };
  return moving.any_own_triangles(parts_, margin, carried, [&](std::int32_t t, std::int32_t u) {
    return any_point(t, u) || any_point(u, t) || any_edge(t, u);
  });
}

bool OwnSheet::may_meet(std::int32_t vertex, std::int32_t triangle, const Positions& q, const Positions& x,
                        double margin) const {
  if (are_beside(vertex, triangle)) return false;
  const std::array<std::int32_t, 3> corners = {triangles_(triangle, 0), triangles_(triangle, 1),
                                               triangles_(triangle, 2)};
  const double before = distance_to_triangle(q.row(vertex), corners_of(triangle, q));
  const double motion = motion_beside(std::array{vertex}, corners, q, x);
  if (before - motion > margin) return false;
  const double after = distance_to_triangle(x.row(vertex), corners_of(triangle, x));
  return may_come_nearer(before, after, motion, margin) && is_apart(vertex, triangle);
}

bool OwnSheet::may_meet(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x,
                        double margin) const {
  if (are_beside(one, other)) return false;
  const double before = distance_of_edges({one, other, q}), motion = motion_beside(one, other, q, x);
  if (before - motion > margin) return false;
  return may_come_nearer(before, distance_of_edges({one, other, x}), motion, margin) && are_apart(one, other);
}

bool OwnSheet::touches(const MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const {
  const auto points = [&](std::int32_t v, std::int32_t t) {
    if (!may_meet(v, t, q, x, layer_)) return false;
    const std::optional<Over> begins = over(corners_of(t, q), q.row(v));
    return (begins && std::abs(begins->above) < layer_) ||
           moving.first_crossing(std::span(&t, 1), q.row(v), x.row(v), 1).has_value();
  };
  const auto edges = [&](const EdgeEnds& one, const EdgeEnds& other) {
    if (!may_meet(one, other, q, x, 0.5 * layer_)) return false;
    const TwoEdges begins(one, other, q), ends(one, other, x);
    return (begins.are_nearer(0.5 * layer_) && begins.meet(0)) ||
           (begins.volume * ends.volume < 0 && edge_passage(one, other, q, x).has_value());
  };
  return any_pair(moving, layer_, carried, q, x, points, edges);
}

bool OwnSheet::overlaps(const MovingSurface& moving, const Positions& q) const {
  return touches(moving, q, q, Vec3::Zero());
}

std::optional<Vec3> OwnSheet::crossing(const MovingSurface& moving, const Positions& q) const {
  std::optional<Vec3> place;
  const auto passes = [&](std::int32_t edges_of, std::int32_t t) {
    for (const EdgeEnds& edge : edges_.of(edges_of)) {
      bool apart = true;
      for (const std::int32_t v : edge)
        for (int k = 0; k < 3; ++k) apart &= !are_neighbours(v, triangles_(t, k));
      if (!apart) continue;
      const Vec3 from = q.row(edge[0]), to = q.row(edge[1]);
      const auto passage = moving.first_crossing(std::span(&t, 1), from, to, 1);
      if (passage) place = from + passage->share * (to - from);
    }
    return place.has_value();
  };
  moving.any_own_triangles(parts_, 0, Vec3::Zero(),
                           [&](std::int32_t t, std::int32_t u) { return passes(t, u) || passes(u, t); });
  return place;
}

void OwnSheet::find_pairs(const MovingSurface& moving, const Positions& q, const Positions& x, double margin,
                          const Vec3& carried, Pairs& pairs) const {
  pairs.points.clear();
  pairs.edges.clear();
  const auto points = [&](std::int32_t v, std::int32_t t) {
    if (may_meet(v, t, q, x, margin)) pairs.points.push_back({v, t, volume(corners_of(t, q), q.row(v))});
    return false;
  };
  const auto edges = [&](const EdgeEnds& one, const EdgeEnds& other) {
    if (may_meet(one, other, q, x, margin)) pairs.edges.push_back({one, other, TwoEdges(one, other, q).volume});
    return false;
  };
  any_pair(moving, margin, carried, q, x, points, edges);
}

}  // namespace supple
