#include "geometry/shapes/triangle_in_shape.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr double distinct = 0.1;    // places nearer to each other than this are one, over the longest edge
constexpr double precision = 1e-3;  // of a place, over the longest edge
constexpr int most_steps = 12;
constexpr int most_halvings = 3;

// Returns the share of the way from a to b at which it is closest to p.
double along_edge(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 way = b - a;
  const double squared = way.squaredNorm();
  return squared > 0 ? std::clamp((p - a).dot(way) / squared, 0.0, 1.0) : 0.0;
}

}  // namespace

// Tries the foot of the perpendicular from p to the plane. Where it lies outside of the triangle, the closest point is
// on one of the three edges.
Vec3 closest_weights(const TriangleCorners& corners, const Vec3& p) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0], d = p - corners[0];
  const Vec3 n = u.cross(v);
  const double squared = n.squaredNorm();
  if (squared > 0) {
    const double b = d.cross(v).dot(n) / squared, c = u.cross(d).dot(n) / squared;
    if (b >= 0 && c >= 0 && b + c <= 1) return Vec3(1 - b - c, b, c);
  }
  Vec3 best = Vec3::Zero();
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    const int other = (k + 1) % 3;
    const double share = along_edge(corners[k], corners[other], p);
    const double away = (corners[k] + share * (corners[other] - corners[k]) - p).squaredNorm();
    if (away >= least) continue;
    least = away;
    best.setZero();
    best[k] = 1 - share;
    best[other] = share;
  }
  return best;
}

// Two convex bodies are apart if and only if they are so along the normal of a face or the cross product of an edge of
// each (the separating axis theorem; Akenine-Moeller 2001, "Fast 3D triangle-box overlap testing").
bool meets_box(const TriangleCorners& corners, const Bounds& box, double grown) {
  const Vec3 half = (0.5 * (box.upper - box.lower)).array() + grown;
  if (half.minCoeff() < 0) return false;
  const Vec3 center = 0.5 * (box.lower + box.upper);
  const TriangleCorners at = {corners[0] - center, corners[1] - center, corners[2] - center};
  const auto apart = [&](const Vec3& axis) {
    const double a = axis.dot(at[0]), b = axis.dot(at[1]), c = axis.dot(at[2]), reach = half.dot(axis.cwiseAbs());
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  for (int i = 0; i < 3; ++i) {
    if (apart(Vec3::Unit(i))) return false;
  }
  const TriangleCorners edges = {at[1] - at[0], at[2] - at[1], at[0] - at[2]};
  if (apart(edges[0].cross(edges[1]))) return false;
  for (const Vec3& edge : edges) {
    for (int i = 0; i < 3; ++i) {
      if (apart(Vec3::Unit(i).cross(edge))) return false;
    }
  }
  return true;
}

TriangleInShape::TriangleInShape(const ShapeProbe& shape, double half_thickness, const TriangleCorners& corners,
                                 QueryMemory& near)
    : shape_(shape), corners_(corners), near_(near) {
  edge_ = 0;
  for (int k = 0; k < 3; ++k) edge_ = std::max(edge_, (corners[(k + 1) % 3] - corners[k]).norm());
  half_thickness_ = half_thickness;
  center_ = ask(Vec3::Constant(1.0 / 3));
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    const double along = center_.surface.normal.dot(corners[k] - center_.point);
    if (along >= least) continue;
    least = along;
    nearest_corner_ = k;
  }
  bound_ = center_.surface.distance + least;
}

TrianglePlace TriangleInShape::ask(const Vec3& weights) const {
  TrianglePlace place{weights, weights[0] * corners_[0] + weights[1] * corners_[1] + weights[2] * corners_[2], {}};
  place.surface = shape_.closest(place.point, near_);
  return place;
}

double TriangleInShape::distance_at_nearest_corner() const {
  return shape_.closest(corners_[nearest_corner_], near_).distance;
}

// Goes again and again from a place to the triangle's point that is closest to a target a little deeper than the
// surface's closest point. Outside, these are alternating projections onto two convex sets; inside, each is a step down
// the slope. A step is shortened until the distance decreases.
TrianglePlace TriangleInShape::descend_from(TrianglePlace place) const {
  for (int step = 0; step < most_steps; ++step) {
    const double outside = std::max(0.0, place.surface.distance), inside = std::max(0.0, -place.surface.distance);
    double way = outside + std::clamp(half_thickness_, std::max(inside, 0.02 * edge_), edge_ + inside);
    bool better = false;
    double moved = 0;
    for (int halving = 0; halving <= most_halvings && !better; ++halving, way /= 4) {
      const Vec3 weights = closest_weights(corners_, place.point - way * place.surface.normal);
      const TrianglePlace next = ask(weights);
      moved = (next.point - place.point).norm();
      if (moved <= precision * edge_) return place;
      better = next.surface.distance < place.surface.distance - 1e-4 * moved;
      if (better) place = next;
    }
    if (!better) return place;
  }
  return place;
}

TriangleInShape::Descent TriangleInShape::descend() const {
  Descent found;
  const auto add = [&](const TrianglePlace& place) {
    for (int i = 0; i < found.count; ++i) {
      if ((found.places[i].point - place.point).norm() < distinct * edge_) return;
    }
    found.places[found.count++] = place;
  };
  add(descend_from(center_));
  for (int k = 0; k < 3; ++k) {
    const TrianglePlace corner = ask(Vec3::Unit(k));
    found.at_corners = std::min(found.at_corners, corner.surface.distance);
    add(descend_from(corner));
  }
  return found;
}

}  // namespace supple
