#include "sim/contact/face_points.h"

#include <algorithm>
#include <cmath>

#include "geometry/shapes/triangle_in_shape.h"
#include "sim/contact/reach.h"
#include "sim/contact/usual_depth.h"

namespace supple {
namespace {

constexpr int group_size = 64;           // consecutive triangles
constexpr int face_groups_a_chunk = 4;   // a thread takes so many; fixed, so that results do not depend on threads
constexpr double least_weight = 1e-3;    // a point with a smaller one belongs to the opposite edge
constexpr double same_place = 2;         // points nearer to each other than this, over the slack, are one
constexpr double same_weight = 0.1;      // points whose weights differ by less are one
constexpr int most_points = 8;           // most points of one triangle or edge in a step
constexpr double unheld = 1.1;           // depth at which an iterate needs further points, over the slack
constexpr double seen_from = 2;          // distance from which the surface beside a point is seen, over the slack
constexpr double least_alignment = 0.3;  // cosine between a surface's normal and the directions across a face or edge

int groups_of(const Model& model) { return static_cast<int>((model.surface.rows() + group_size - 1) / group_size); }
int end_of(const Model& model, int group) {
  return static_cast<int>(std::min<Eigen::Index>(model.surface.rows(), (group + 1) * group_size));
}

double longest_edge_squared(const TriangleCorners& corners) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (corners[(k + 1) % 3] - corners[k]).squaredNorm());
  return longest;
}

double longest_edge_squared(const Model& model, const Positions& q) {
  double longest = 0;
  for (const auto& corner : model.surface.rowwise())
    longest = std::max(longest, longest_edge_squared({q.row(corner[0]), q.row(corner[1]), q.row(corner[2])}));
  return longest;
}

// Returns the depth below which contact of a body's points with a piece begins [m]. size: the size of the body [m].
double slack_of(const FacePoints::Piece& piece, double size) { return std::min(usual_depth(size), piece.most_slack); }

// Tells whether a triangle whose corners lie outside a bulge may reach deeper than the slack: its points are at most
// 1/sqrt(3) of the longest edge from the nearest corner, so that it cuts off a cap of at most this edge^2 / (6 radius)
// in height.
bool is_finer(const FacePoints::Piece& piece, double slack, double thickness, double edge_squared) {
  return edge_squared > 6 * (piece.piece.bulge + thickness) * slack;
}

// Returns the stencil of the point of a triangle with these weights. Weights that are next to nothing are left out, so
// that it may be the stencil of a point of an edge, or of a vertex.
ContactStencil stencil_at(const Model& model, Eigen::Index triangle, const Vec3& weights) {
  std::array<std::pair<std::int32_t, double>, 3> parts;
  int count = 0;
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] < least_weight) continue;
    const std::int32_t v = model.surface(triangle, k);
    int place = count++;
    for (; place > 0 && parts[place - 1].first > v; --place) parts[place] = parts[place - 1];
    parts[place] = {v, weights[k]};
    sum += weights[k];
  }
  ContactStencil point = ContactStencil::at_vertex(parts[0].first);
  point.count = count;
  point.free = 0;
  for (int k = 0; k < count; ++k) {
    point.vertex[k] = parts[k].first;
    point.weight[k] = parts[k].second / sum;
    point.free += parts[k].first < model.free;
  }
  return point;
}

// Returns a unit vector out of the collider, at a place of a body's triangle: the collider's normal without its part
// along the triangle or, for a place on an edge (the weights tell), along the edge. Where next to nothing is left,
// returns the normal itself.
Vec3 straight_out(const TriangleCorners& corners, const Vec3& weights, const Vec3& normal) {
  int other = -1, count = 0;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] >= least_weight) {
      ++count;
    } else {
      other = k;
    }
  }
  Vec3 part = normal;
  if (count == 3) {
    const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    part = normal.dot(across) * across;
  } else if (count == 2) {
    const Vec3 along = (corners[(other + 2) % 3] - corners[(other + 1) % 3]).normalized();
    part = normal - normal.dot(along) * along;
  }
  return part.norm() > least_alignment ? part.normalized() : normal;
}

// Examines triangles against one collider, at q (`at_start`) or at an iterate.
struct TriangleSearch {
  const Model& model;
  const ColliderView& view;
  const Positions& q;
  const Positions& x;
  const Positions& y;
  bool at_start;
  const FacePoints& faces;

  TriangleCorners corners(Eigen::Index triangle) const {
    TriangleCorners places;
    for (int k = 0; k < 3; ++k) {
      const Vec3 place = x.row(model.surface(triangle, k));
      places[k] = at_start ? view.at_start(place) : view.at_end(place);
    }
    return places;
  }

  // Returns how far from the surface a triangle may be at the start, if it is to reach the surface in the step [m].
  double reach(Eigen::Index triangle) const {
    double freely = 0;
    for (const std::int32_t v : model.surface.row(triangle))
      freely = std::max(freely, view.length_to(y.row(v), view.way(q.row(v), q.row(v))));
    return freely + reach_of(0, freely);
  }

  // Returns the distance from a piece beyond which a place needs no point; a negative distance is a depth.
  double furthest(double reach, double slack) const {
    return faces.thickness + (at_start ? reach - slack : -unheld * slack);
  }

  // Returns the normal of the surface that holds a place which an iterate has led into the collider. Beyond the middle
  // of a thin bar, the closest surface is not the one through which the place came.
  Vec3 normal_at(const ContactStencil& stencil, const TrianglePlace& place) const {
    QueryMemory near;
    const Way way = view.way(stencil.at(q), stencil.at(x));
    const std::optional<SurfacePoint> held = view.holding(way, view.distance(way.a, near), 0, near);
    return held ? held->normal : place.surface.normal;
  }

  // Adds the candidates of one triangle against one piece.
  void examine(Eigen::Index triangle, const TriangleCorners& corners, double within, const FacePoints::Piece& piece,
               double slack, std::vector<FacePoints::Candidate>& found) const {
    const ShapeProbe probe(piece.piece.shape);
    QueryMemory near;
    const TriangleInShape search(probe, piece.piece.half_thickness, corners, near);
    double radius = 0;
    for (const Vec3& corner : corners) radius = std::max(radius, (corner - search.center().point).norm());
    if (search.center().surface.distance - radius > within) return;
    if (piece.piece.convex) {  // no place of the triangle is below the bound
      if (search.bound() > within || search.distance_at_nearest_corner() - search.bound() <= slack) return;
    }
    const TriangleInShape::Descent least = search.descend();
    for (int i = 0; i < least.count; ++i) {
      const TrianglePlace& place = least.places[i];
      if (place.surface.distance > within || place.surface.distance + slack > least.at_corners) continue;
      const ContactStencil stencil = stencil_at(model, triangle, place.weights);
      if (stencil.is_vertex() || stencil.free == 0) continue;
      const Vec3 normal = at_start ? place.surface.normal : normal_at(stencil, place);
      found.push_back({stencil, slack, seen_from * slack * straight_out(corners, place.weights, normal), near});
    }
  }

  // Returns the longest way of a group's vertices since the start or, at the start, the way that they may make, as seen
  // from the collider.
  double longest_way(int group) const {
    const Positions& to = at_start ? y : x;
    double longest = 0;
    for (int t = group * group_size; t < end_of(model, group); ++t) {
      for (const std::int32_t v : model.surface.row(t))
        longest = std::max(longest, (to.row(v) - q.row(v)).squaredNorm());
    }
    longest = std::sqrt(longest) + faces.collider_move[group];
    return at_start ? longest + reach_of(0, longest) : longest;
  }

  // Adds the candidates of a group's triangles.
  void examine_group(int group, std::vector<FacePoints::Candidate>& found) const {
    if (longest_way(group) < view.clear(faces.distance[group])) return;
    for (int t = group * group_size; t < end_of(model, group); ++t) {
      const TriangleCorners places = corners(t);
      const double edge = longest_edge_squared(places), reached = at_start ? reach(t) : 0;
      const double size = model.part_of(model.surface(t, 0)).size;
      for (const FacePoints::Piece& piece : faces.pieces) {
        const double slack = slack_of(piece, size), within = furthest(reached, slack);
        if (!is_finer(piece, slack, faces.thickness, edge) || !meets_box(places, piece.box, within)) continue;
        examine(t, places, within, piece, slack, found);
      }
    }
  }
};

// Tells whether the same edge or face has a point so near that it may stand for this one, or as many points as it may
// have. A thin piece needs points closer to each other than a round one.
bool is_known(const FacePoints& faces, const FacePoints::Candidate& candidate, const Positions& q) {
  const ContactStencil& stencil = candidate.stencil;
  const double edge = (q.row(stencil.vertex[1]) - q.row(stencil.vertex[0])).norm();
  const double same = std::min(same_weight, same_place * candidate.slack / edge);
  int known = 0;
  for (std::int32_t i = faces.newest[stencil.vertex[0]]; i >= 0; i = faces.points[i].earlier) {
    const ContactStencil& other = faces.points[i].stencil;
    if (other.count != stencil.count || other.vertex != stencil.vertex) continue;
    double apart = 0;
    for (int k = 0; k < stencil.count; ++k) apart = std::max(apart, std::abs(other.weight[k] - stencil.weight[k]));
    if (apart < same || ++known >= most_points) return true;
  }
  return false;
}

// Runs a search over all groups, and adds the points that are new in the order of the triangles.
void search_all(const TriangleSearch& search, Threads* threads, FacePoints& faces) {
  const int groups = groups_of(search.model), chunks = (groups + face_groups_a_chunk - 1) / face_groups_a_chunk;
  faces.by_chunk.resize(chunks);
  run_chunks(threads, chunks, long(search.model.surface.rows()) * 4, [&](int chunk) {
    std::vector<FacePoints::Candidate>& found = faces.by_chunk[chunk];
    found.clear();
    for (int group = chunk * face_groups_a_chunk; group < std::min(groups, (chunk + 1) * face_groups_a_chunk); ++group)
      search.examine_group(group, found);
  });
  for (const auto& list : faces.by_chunk) {
    for (const FacePoints::Candidate& candidate : list) {
      if (is_known(faces, candidate, search.q)) continue;
      FacePoint face{candidate.stencil, candidate.slack,
                     candidate.out,     0,
                     candidate.near,    faces.newest[candidate.stencil.vertex[0]]};
      const Vec3 start = search.view.at_start(candidate.stencil.at(search.q));
      face.field = search.view.distance(start + face.out, face.near) - face.out.norm();
      faces.newest[candidate.stencil.vertex[0]] = static_cast<std::int32_t>(faces.points.size());
      faces.points.push_back(face);
    }
  }
}

// Keeps the pieces of a collider that are finer than the longest edge of the surface, for the smallest body.
void choose_pieces(const Model& model, const Collider& collider, const Positions& q, FacePoints& faces) {
  faces.pieces.clear();
  double longest = -1;
  double size = model.size;
  for (const Part& part : model.parts) size = std::min(size, part.size);
  for (ShapePiece& shape : pieces_of(collider.shape)) {
    if (std::isinf(shape.bulge)) continue;
    const double most_slack = most_depth(collider, shape.half_thickness);
    const Bounds box = shape.shape.bounds();
    FacePoints::Piece piece{std::move(shape), most_slack, box};
    if (longest < 0) longest = longest_edge_squared(model, q);
    if (is_finer(piece, slack_of(piece, size), collider.thickness, longest)) faces.pieces.push_back(std::move(piece));
  }
}

// Finds how far each group is from the collider at least, and how far the collider moves there at most.
void measure_groups(const Model& model, const ColliderView& view, const Positions& q, FacePoints& faces) {
  faces.distance.resize(groups_of(model));
  faces.collider_move.resize(groups_of(model));
  for (int group = 0; group < groups_of(model); ++group) {
    Bounds box;
    for (int t = group * group_size; t < end_of(model, group); ++t) {
      for (const std::int32_t v : model.surface.row(t)) box.include(q.row(v));
    }
    const Vec3 center = box.center();
    const double radius = 0.5 * box.diagonal();
    QueryMemory near;
    faces.collider_move[group] = view.most_moved(center, radius);
    faces.distance[group] = view.least_distance(center, radius, near);
  }
}

}  // namespace

void begin_face_points(const Model& model, const Collider& collider, const ColliderView& view, const Positions& q,
                       const Positions& y, Threads* threads, FacePoints& faces) {
  faces.points.clear();
  faces.pieces.clear();
  faces.thickness = collider.thickness;
  choose_pieces(model, collider, q, faces);
  if (faces.pieces.empty()) return;
  faces.newest.assign(model.vertices, -1);
  measure_groups(model, view, q, faces);
  search_all({model, view, q, q, y, true, faces}, threads, faces);
}

void find_face_points(const Model& model, const ColliderView& view, const Positions& q, const Positions& x,
                      const Positions& y, Threads* threads, FacePoints& faces) {
  if (!faces.pieces.empty()) search_all({model, view, q, x, y, false, faces}, threads, faces);
}

std::optional<SurfacePoint> plane_of(const ColliderView& view, const FacePoint& face, const Way& way, double reach,
                                     QueryMemory& near) {
  const double out = face.out.norm();
  Way beside = way;
  beside.a += face.out;
  beside.b += face.out;
  beside.q += view.start().linear() * face.out;
  beside.x += view.end().linear() * face.out;
  std::optional<SurfacePoint> plane;
  const SurfacePoint here = view.closest(beside.b, near);
  if (here.distance < 0) {
    // Inside something thin, the side by which the point entered may be further than another one.
    const std::optional<ColliderView::Entry> entered = view.entry(beside, face.field + out, near);
    if (entered && entered->surface.normal.dot(face.out) > (here.normal.dot(face.out) + 0.2 * out))
      plane = entered->surface;
  }
  if (!plane) plane = view.holding(beside, face.field + out, reach + out, near);
  if (!plane) return std::nullopt;
  const double gap = plane->normal.dot(beside.b - plane->point) - out;
  return SurfacePoint{way.b - gap * plane->normal, plane->normal, gap};
}

}  // namespace supple
