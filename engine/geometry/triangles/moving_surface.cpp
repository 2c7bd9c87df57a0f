#include "geometry/triangles/moving_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "geometry/triangles/moving_boxes.h"
#include "geometry/triangles/point_passage.h"

namespace supple {
namespace {

// Describes the point of a triangle that is closest to the origin.
struct Foot {
  Vec3 weights;  // zero for corners that the point's edge or corner does not have
  Vec3 offset;   // the point [m]
};

// Returns the closest point on those edges beyond which the origin's foot on the plane lies, which are opposite to
// corners without positive weight: each point outside a triangle has its closest point on one of these.
Foot foot_on_edges(const std::array<Vec3, 3>& corners, const Vec3& weights) {
  Foot best{Vec3(1, 0, 0), corners[0]};
  double least = infinity;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (weights[3 - k - next] > 0) continue;
    const Vec3 &from = corners[std::size_t(k)], along = corners[std::size_t(next)] - from;
    const double length = along.squaredNorm(), share = length > 0 ? std::clamp(-from.dot(along) / length, 0.0, 1.0) : 0;
    const Vec3 offset = from + share * along;
    const double squared = offset.squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    best = {Vec3::Zero(), offset};
    best.weights[k] = 1 - share;
    best.weights[next] = share;
  }
  return best;
}

// Returns the point of a triangle that is closest to the origin. Round-off hides on which side of an edge of a needle
// the foot lies, so all edges of a needle are looked at. The normal of a triangle that is almost a line is unknown, and
// its edges are as near as its plane.
Foot foot_in_triangle(const std::array<Vec3, 3>& corners) {
  constexpr double needle = 1e-12, almost_a_line = 1e-24;  // squared sine of the angle at the first corner
  const Vec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], area = ab.cross(ac);
  const double squared = area.squaredNorm(), rectangle = ab.squaredNorm() * ac.squaredNorm();
  if (!(squared > almost_a_line * rectangle)) return foot_on_edges(corners, Vec3::Zero());
  const double v = ac.cross(corners[0]).dot(area) / squared, w = corners[0].cross(ab).dot(area) / squared;
  const Vec3 weights(1 - v - w, v, w);
  if (weights.minCoeff() > 0) return {weights, corners[0] + v * ab + w * ac};
  return foot_on_edges(corners, squared > needle * rectangle ? weights : Vec3(Vec3::Zero()));
}

template <class Boxes>
auto squared_distances(const Boxes& boxes, const Vec3& p) {
  auto sum = Boxes::Lanes::Zero().eval();
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = std::size_t(axis);
    sum += (boxes.lower[k] - p[axis]).max(p[axis] - boxes.upper[k]).max(0).square();
  }
  return sum;
}

Vec3 normalized_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

MovingSurface::MovingSurface(Triangles triangles, const Positions& rest) : triangles_(std::move(triangles)) {
  SUPPLE_CHECK(triangles_.rows(), >, 0);
  SUPPLE_CHECK(triangles_.minCoeff(), >=, 0);
  SUPPLE_CHECK(triangles_.maxCoeff(), <, rest.rows());
  start_.x = end_.x = rest;
  add_node(triangle_tree({rest, triangles_}, TreeCut::smallest_boxes), 0);
  list_triangles_around();
  list_own_vertices();
  Boxes empty;
  empty.lower.fill(Boxes::Lanes::Constant(infinity));
  empty.upper.fill(Boxes::Lanes::Constant(-infinity));
  start_.boxes.assign(nodes_.size(), empty);
  set(start_, rest);
  end_ = start_;
}

// Returns the index of the new node.
std::int32_t MovingSurface::add_node(const TriangleTree& tree, std::int32_t from) {
  const auto index = std::int32_t(nodes_.size());
  Node node;
  node.child.fill(-1);
  nodes_.push_back(node);
  const TriangleTree::Node& whole = tree.nodes[std::size_t(from)];
  if (whole.is_leaf()) {
    for (const std::int32_t t : tree.triangles_of(whole)) node.child[std::size_t(node.count++)] = ~t;
  } else {
    const TriangleTree::Parts parts = tree.four_parts(from);
    for (int k = 0; k < parts.count; ++k)
      node.child[std::size_t(node.count++)] = add_node(tree, parts.node[std::size_t(k)]);
  }
  nodes_[std::size_t(index)] = node;
  return index;
}

void MovingSurface::list_triangles_around() {
  around_start_.assign(std::size_t(start_.x.rows()) + 1, 0);
  for (const std::int32_t v : triangles_.reshaped()) ++around_start_[std::size_t(v) + 1];
  for (std::size_t v = 1; v < around_start_.size(); ++v) around_start_[v] += around_start_[v - 1];
  around_.resize(std::size_t(triangles_.size()));
  std::vector<std::int32_t> next(around_start_.begin(), around_start_.end() - 1);
  for (std::int32_t t = 0; t < triangles_.rows(); ++t)
    for (int k = 0; k < 3; ++k) around_[std::size_t(next[std::size_t(triangles_(t, k))]++)] = t;
}

void MovingSurface::list_own_vertices() {
  std::vector<char> is_listed(std::size_t(start_.x.rows()), 0);
  for (Node& node : nodes_) {
    if (!node.is_leaf()) continue;
    node.first_vertex = std::int32_t(own_vertices_.size());
    for (int c = 0; c < node.count; ++c) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = triangles_(~node.child[std::size_t(c)], k);
        if (!std::exchange(is_listed[std::size_t(v)], 1)) own_vertices_.push_back(v);
      }
    }
    node.vertices = std::int32_t(own_vertices_.size()) - node.first_vertex;
  }
}

void MovingSurface::set_start(const Positions& x) {
  if (x.rows() == end_.x.rows() && x == end_.x) {
    start_ = end_;
  } else {
    set(start_, x);
  }
}

// Sets the places of a pose, and its boxes from the last node to the first: children have larger indices than their
// node, so that their boxes are known when those of the node are made.
void MovingSurface::set(Pose& pose, const Positions& x) {
  SUPPLE_CHECK(x.rows(), ==, std::ssize(around_start_) - 1);
  pose.x = x;
  pose.number = ++poses_;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int c = 0; c < node.count; ++c) {
      const std::int32_t child = node.child[std::size_t(c)];
      Bounds box;
      if (child < 0) {
        const Vec3 first = corner(pose, ~child, 0), second = corner(pose, ~child, 1), third = corner(pose, ~child, 2);
        box = {first.cwiseMin(second).cwiseMin(third), first.cwiseMax(second).cwiseMax(third)};
      } else {
        box = whole_box(pose.boxes[std::size_t(child)]);
      }
      for (int axis = 0; axis < 3; ++axis) {
        pose.boxes[n].lower[std::size_t(axis)][c] = box.lower[axis];
        pose.boxes[n].upper[std::size_t(axis)][c] = box.upper[axis];
      }
    }
  }
  pose.bounds = whole_box(pose.boxes[0]);
  pose.on_surface = 1e-9 * pose.bounds.lower.cwiseAbs().cwiseMax(pose.bounds.upper.cwiseAbs()).maxCoeff();
}

std::span<const std::int32_t> MovingSurface::around(std::int32_t vertex) const {
  const std::int32_t first = around_start_[std::size_t(vertex)], last = around_start_[std::size_t(vertex) + 1];
  return {around_.data() + first, std::size_t(last - first)};
}

Vec3 MovingSurface::unit_normal(const Pose& pose, std::int32_t t) const {
  const Vec3 first = corner(pose, t, 0);
  return normalized_or_zero((corner(pose, t, 1) - first).cross(corner(pose, t, 2) - first));
}

// Sums the normals of all triangles at an edge, which may be more than two.
Vec3 MovingSurface::edge_normal(const Pose& pose, std::int32_t a, std::int32_t b) const {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t t : around(a))
    if ((triangles_.row(t).array() == b).any()) sum += unit_normal(pose, t);
  return sum;
}

// Sums the normals of all triangles at a vertex, weighted by their angles there.
Vec3 MovingSurface::vertex_normal(const Pose& pose, std::int32_t vertex) const {
  const Vec3 at = pose.x.row(vertex);
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t t : around(vertex)) {
    const int k = triangles_(t, 0) == vertex ? 0 : triangles_(t, 1) == vertex ? 1 : 2;
    const Vec3 one = corner(pose, t, (k + 1) % 3) - at, other = corner(pose, t, (k + 2) % 3) - at;
    const Vec3 area = one.cross(other);
    const double size = area.norm();
    if (size > 0) sum += std::atan2(size, one.dot(other)) / size * area;
  }
  return sum;
}

// Returns the unit pseudonormal of the face, edge or corner to which the corners with positive weights belong.
Vec3 MovingSurface::pseudonormal(const Pose& pose, std::int32_t t, const Vec3& weights) const {
  std::array<std::int32_t, 3> vertex{};
  int count = 0;
  for (int k = 0; k < 3; ++k)
    if (weights[k] > 0) vertex[std::size_t(count++)] = triangles_(t, k);
  if (count == 3) return unit_normal(pose, t);
  return normalized_or_zero(count == 2 ? edge_normal(pose, vertex[0], vertex[1]) : vertex_normal(pose, vertex[0]));
}

Vec3 MovingSurface::normal_at_start(std::int32_t vertex) const {
  return normalized_or_zero(vertex_normal(start_, vertex));
}
Vec3 MovingSurface::normal_at_end(std::int32_t vertex) const { return normalized_or_zero(vertex_normal(end_, vertex)); }

double MovingSurface::distance_at_end(std::int32_t t, const Vec3& p) const {
  return foot_in_triangle({corner(end_, t, 0) - p, corner(end_, t, 1) - p, corner(end_, t, 2) - p}).offset.norm();
}

std::optional<MovingSurface::Place> MovingSurface::closest(const Pose& pose, const Vec3& p, double most,
                                                           const Takes* takes) const {
  struct Waiting {
    double squared;
    std::int32_t child;
  };
  const auto is_further = [](const Waiting& a, const Waiting& b) { return b.squared < a.squared; };
  TreeStack<Waiting> stack({0, 0});
  double least = most * most;
  std::int32_t triangle = -1;
  Foot foot;
  while (!stack.empty()) {
    const Waiting waiting = stack.pop();
    if (waiting.squared > least) continue;
    if (waiting.child < 0) {
      const std::int32_t t = ~waiting.child;
      const Foot own = foot_in_triangle({corner(pose, t, 0) - p, corner(pose, t, 1) - p, corner(pose, t, 2) - p});
      const double squared = own.offset.squaredNorm();
      if (!(triangle < 0 ? squared <= least : squared < least)) continue;
      if (takes != nullptr && !(*takes)(t)) continue;
      least = squared;
      triangle = t;
      foot = own;
      continue;
    }
    const Node& node = nodes_[std::size_t(waiting.child)];
    const Boxes::Lanes squared = squared_distances(pose.boxes[std::size_t(waiting.child)], p);
    const int first = stack.size();
    for (int c = 0; c < node.count; ++c)
      if (squared[c] <= least) stack.push_below(first, {squared[c], node.child[std::size_t(c)]}, is_further);
  }
  if (triangle < 0) return std::nullopt;
  return seen_from(p, pose, triangle, foot.weights, foot.offset);
}

std::optional<MovingSurface::Place> MovingSurface::closest_among(const Pose& pose,
                                                                 std::span<const std::int32_t> triangles, const Vec3& p,
                                                                 double most, const Takes& takes) const {
  double least = most * most;
  std::int32_t triangle = -1;
  Foot foot;
  for (const std::int32_t t : triangles) {
    const Foot own = foot_in_triangle({corner(pose, t, 0) - p, corner(pose, t, 1) - p, corner(pose, t, 2) - p});
    const double squared = own.offset.squaredNorm();
    if (!(triangle < 0 ? squared <= least : squared < least) || !takes(t)) continue;
    least = squared;
    triangle = t;
    foot = own;
  }
  if (triangle < 0) return std::nullopt;
  return seen_from(p, pose, triangle, foot.weights, foot.offset);
}

// Returns a place of a triangle as it is seen from p. offset: from p to the place. Above a face, the gradient is the
// normal of the face; elsewhere it is along the offset.
MovingSurface::Place MovingSurface::seen_from(const Vec3& p, const Pose& pose, std::int32_t t, const Vec3& weights,
                                              const Vec3& offset) const {
  const Vec3 pseudo = pseudonormal(pose, t, weights);
  const double length = offset.norm(), sign = offset.dot(pseudo) <= 0 ? 1 : -1;
  const bool is_face = (weights.array() > 0).all();
  const bool has_direction = length > pose.on_surface && !is_face;
  Vec3 normal = has_direction ? Vec3(-sign / length * offset) : pseudo;
  if (normal.isZero(0)) normal = length > 0 ? Vec3(-sign / length * offset) : Vec3(Vec3::UnitY());
  return {t, weights, p + offset, sign * length, normal};
}

// Calls visit(triangle) for each triangle that moves through the box, until one call returns true; tells whether one
// did. The box is in the frame that moves by `carried`.
template <class Visit>
bool MovingSurface::any_triangle(const Bounds& box, const Vec3& carried, const Visit& visit) const {
  TreeStack<std::int32_t> stack(0);
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    if (index < 0) {
      if (visit(~index)) return true;
      continue;
    }
    const Node& node = nodes_[std::size_t(index)];
    const Boxes::Lanes gap = gaps(start_.boxes[std::size_t(index)], end_.boxes[std::size_t(index)], carried, box);
    for (int c = 0; c < node.count; ++c)
      if (gap[c] <= 0) stack.push(node.child[std::size_t(c)]);
  }
  return false;
}

std::optional<MovingSurface::Entry> MovingSurface::first_entry(const Vec3& a, const Vec3& b, const Vec3& carried,
                                                               double latest, const Takes* takes) const {
  return first_passing(a, b, carried, latest, false, takes);
}

std::optional<MovingSurface::Entry> MovingSurface::first_entry(std::span<const std::int32_t> triangles, const Vec3& a,
                                                               const Vec3& b, double latest) const {
  std::optional<Entry> first;
  for (const std::int32_t t : triangles) take_if_earlier(t, seen_triangle(t, a, b), roundoff_at(a, b), latest, first);
  return first;
}

std::optional<MovingSurface::Entry> MovingSurface::first_crossing(const Vec3& a, const Vec3& b, const Vec3& carried,
                                                                  double latest) const {
  const double roundoff = roundoff_at(a, b);
  std::optional<Entry> first;
  any_triangle(box_of_path(a, b, carried, roundoff + roundoff_at(b, carried)), carried, [&](std::int32_t t) {
    take_first_crossing(t, a, b, roundoff, latest, first);
    return false;
  });
  return first;
}

std::optional<MovingSurface::Entry> MovingSurface::first_crossing(std::span<const std::int32_t> triangles,
                                                                  const Vec3& a, const Vec3& b, double latest) const {
  std::optional<Entry> first;
  for (const std::int32_t t : triangles) take_first_crossing(t, a, b, roundoff_at(a, b), latest, first);
  return first;
}

// Replaces `first` by the passage through a triangle from either side, if there is one up to `latest` that is earlier.
void MovingSurface::take_first_crossing(std::int32_t t, const Vec3& a, const Vec3& b, double roundoff, double latest,
                                        std::optional<Entry>& first) const {
  SeenTriangle seen = seen_triangle(t, a, b);
  take_if_earlier(t, seen, roundoff, latest, first);
  std::swap(seen.start[1], seen.start[2]);
  std::swap(seen.end[1], seen.end[2]);
  std::optional<Entry> from_behind;
  take_if_earlier(t, seen, roundoff, first ? first->share : latest, from_behind);
  if (!from_behind || (first && from_behind->share >= first->share)) return;
  first = from_behind;
  std::swap(first->weights[1], first->weights[2]);
}

// Seen backwards in time, the point enters where it last left.
std::optional<MovingSurface::Entry> MovingSurface::last_exit(const Vec3& a, const Vec3& b, const Vec3& carried) const {
  std::optional<Entry> exit = first_passing(a, b, carried, 1, true, nullptr);
  if (exit) exit->share = 1 - exit->share;
  return exit;
}

std::optional<MovingSurface::Entry> MovingSurface::last_exit_at_start(const Vec3& a, const Vec3& b) const {
  const double roundoff = roundoff_at(a, b);
  std::optional<Entry> exit;
  any_triangle(box_of_path(a, b, Vec3::Zero(), roundoff), Vec3::Zero(), [&](std::int32_t t) {
    SeenTriangle seen;
    for (std::size_t k = 0; k < 3; ++k) {
      seen.start[k] = corner(start_, t, int(k)) - b;
      seen.end[k] = corner(start_, t, int(k)) - a;
    }
    take_if_earlier(t, seen, roundoff, 1, exit);
    return false;
  });
  if (exit) exit->share = 1 - exit->share;
  return exit;
}

std::optional<MovingSurface::Entry> MovingSurface::first_passing(const Vec3& a, const Vec3& b, const Vec3& carried,
                                                                 double latest, bool is_backwards,
                                                                 const Takes* takes) const {
  const double roundoff = roundoff_at(a, b);
  std::optional<Entry> first;
  any_triangle(box_of_path(a, b, carried, roundoff + roundoff_at(b, carried)), carried, [&](std::int32_t t) {
    if (takes != nullptr && !(*takes)(t)) return false;
    SeenTriangle seen = seen_triangle(t, a, b);
    if (is_backwards) std::swap(seen.start, seen.end);
    take_if_earlier(t, seen, roundoff, latest, first);
    return false;
  });
  return first;
}

SeenTriangle MovingSurface::seen_triangle(std::int32_t t, const Vec3& a, const Vec3& b) const {
  SeenTriangle seen;
  for (int k = 0; k < 3; ++k) {
    seen.start[std::size_t(k)] = corner(start_, t, k) - a;
    seen.end[std::size_t(k)] = corner(end_, t, k) - b;
  }
  return seen;
}

// Replaces `first` by the passage through a triangle, if there is one up to `latest` that is earlier.
void MovingSurface::take_if_earlier(std::int32_t t, const SeenTriangle& seen, double roundoff, double latest,
                                    std::optional<Entry>& first) {
  const std::optional<Passage> passage = first_passage(seen, roundoff, first ? first->share : latest);
  if (passage && (!first || passage->share < first->share))
    first = Entry{t, passage->weights, passage->share, passage->normal};
}

bool MovingSurface::is_near(const Vec3& a, const Vec3& b, const Vec3& carried, double margin) const {
  const Bounds box = box_of_path(a, b, carried, margin + roundoff_at(a, b) + roundoff_at(b, carried));
  return any_triangle(box, carried, [](std::int32_t) { return true; });
}

void MovingSurface::visit_triangles_near(const std::array<Vec3, 2>& start, const std::array<Vec3, 2>& end,
                                         const Vec3& carried, double margin, const VisitTriangle& visit) const {
  Bounds box;
  for (std::size_t k = 0; k < 2; ++k) {
    const double reach = margin + roundoff_at(start[k], end[k]) + roundoff_at(end[k], carried);
    const Bounds path = box_of_path(start[k], end[k], carried, reach);
    box.include(path.lower);
    box.include(path.upper);
  }
  any_triangle(box, carried, [&](std::int32_t t) {
    visit(t);
    return false;
  });
}

// Returns the box in which the node's triangles move, in the frame that moves by `carried`.
Bounds MovingSurface::swept_box(std::int32_t node, const Vec3& carried) const {
  const Bounds start = whole_box(start_.boxes[std::size_t(node)]), end = whole_box(end_.boxes[std::size_t(node)]);
  return {start.lower.cwiseMin(end.lower - carried), start.upper.cwiseMax(end.upper - carried)};
}

// Calls visit(leaf) for each leaf of the other surface that may come nearer than the margin, until one call returns
// true; tells whether one did.
template <class Visit>
bool MovingSurface::any_leaf_of(const MovingSurface& other, double margin, const Vec3& carried,
                                const Visit& visit) const {
  TreeStack<std::int32_t> stack(0);
  while (!stack.empty()) {
    const std::int32_t index = stack.pop();
    const Bounds box = other.swept_box(index, carried);
    const double reach = margin + roundoff_at(box.lower, box.upper) + 2 * roundoff_at(carried, carried);
    const Bounds wide = {box.lower.array() - reach, box.upper.array() + reach};
    if (!any_triangle(wide, carried, [](std::int32_t) { return true; })) continue;
    const Node& node = other.nodes_[std::size_t(index)];
    if (node.is_leaf()) {
      if (visit(node)) return true;
      continue;
    }
    for (int c = 0; c < node.count; ++c) stack.push(node.child[std::size_t(c)]);
  }
  return false;
}

bool MovingSurface::may_meet(const MovingSurface& other, double margin, const Vec3& carried) const {
  return any_leaf_of(other, margin, carried, [](const Node&) { return true; });
}

}  // namespace supple
