#include "sim/contact/collider_view.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr int most_marches_of_ray = 200;  // a ray that needs more only grazes the surface
// Below this angle, the arc through a turning frame leaves its chord by less than 0.13 % of the distance to the axis.
constexpr double least_bend = 0.1;

// Tells whether two normals belong to the two sides of a wall, not of an edge.
bool are_opposite(const Vec3& a, const Vec3& b) { return a.dot(b) < -0.5; }
// Tells whether two normals belong to one smooth side.
bool on_one_side(const Vec3& a, const Vec3& b) { return a.dot(b) > 0.5; }

// Tells whether a place inside belongs to the surface by which its way entered, and not to the closest one. That is so
// where the two are sides of a wall or, for a vertex that was outside, sides of an edge, unless the place is ten times
// as deep below the entered surface. A vertex that falls on a thin bar beside its edge would otherwise be thrown off
// sideways. A vertex that was inside already may slide around the edge.
bool is_held_by(const SurfacePoint& entered, const SurfacePoint& closest, const Way& way, bool was_outside) {
  constexpr double far_deeper = 10;
  if (are_opposite(closest.normal, entered.normal)) return true;
  return was_outside && !on_one_side(closest.normal, entered.normal) &&
         entered.normal.dot(entered.point - way.b) < -far_deeper * closest.distance;
}

}  // namespace

ColliderView::ColliderView(const Collider& collider, const ColliderMotion& motion, const ColliderTraits& traits)
    : collider_(collider),
      shape_(collider.shape),
      start_(motion.start),
      end_(motion.end),
      to_start_(motion.start.inverse()),
      to_end_(motion.end.inverse()),
      traits_(traits),
      surface_(motion.deforms() ? motion.surface.get() : nullptr),
      moves_(motion.moves()) {
  if (!moves_ || surface_ != nullptr) return;  // the turns of its triangles bend no ways
  const Eigen::AngleAxisd turn(end_.linear() * start_.linear().transpose());
  bends_ = turn.angle() > least_bend;
  if (!bends_) return;
  angle_ = turn.angle();
  axis_ = turn.axis();
  turn_ = angle_ * axis_;
}

// The pace is the length of a vector that changes evenly, so it is greatest at one of the ends.
double ColliderView::bent_length(const Vec3& q, const Vec3& x) const {
  const Vec3 from = q - start_.translation(), to = x - end_.translation(), straight = to - from;
  return std::max((straight - turn_.cross(from)).norm(), (straight - turn_.cross(to)).norm());
}

Eigen::Isometry3d ColliderView::pose(double share) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate((1 - share) * start_.translation() + share * end_.translation());
  if (!bends_) {
    const Eigen::Quaterniond from(start_.linear()), to(end_.linear());
    return pose.rotate(from.slerp(share, to));
  }
  return pose.rotate(Eigen::AngleAxisd(share * angle_, axis_)).rotate(start_.linear());
}

// Turns back by Rodrigues' formula, which a way asks for many times.
Vec3 ColliderView::at(const Way& way, double share) const {
  if (!bends_) return way.a + share * (way.b - way.a);
  const Vec3 arm = way.q + share * (way.x - way.q) - (1 - share) * start_.translation() - share * end_.translation();
  const double sine = std::sin(share * angle_), cosine = std::cos(share * angle_);
  const Vec3 back = cosine * arm - sine * axis_.cross(arm) + (1 - cosine) * axis_.dot(arm) * axis_;
  return start_.linear().transpose() * back;
}

Vec3 ColliderView::pace(const Way& way, double share) const {
  if (!bends_) return way.b - way.a;
  const Eigen::Isometry3d now = pose(share);
  const Vec3 arm = way.q + share * (way.x - way.q) - now.translation();
  const Vec3 straight = (way.x - end_.translation()) - (way.q - start_.translation());
  return now.linear().transpose() * (straight - turn_.cross(arm));
}

Eigen::Isometry3d ColliderView::motion_after(double share) const { return end_ * pose(share).inverse(); }

Eigen::Isometry3d ColliderView::motion_near(const Vec3& place, double share) const {
  if (surface_ == nullptr) return motion_after(share);
  const Eigen::Isometry3d whole = end_ * shape_.motion_near(to_start_ * place, *surface_) * to_start_;
  const Eigen::AngleAxisd turn(whole.linear());
  Eigen::Isometry3d rest = Eigen::Isometry3d::Identity();
  rest.translate(place + (1 - share) * (whole * place - place));
  return rest.rotate(Eigen::AngleAxisd((1 - share) * turn.angle(), turn.axis())).translate(-place);
}

SurfacePoint ColliderView::on_layer(SurfacePoint s) const {
  s.point += collider_.thickness * s.normal;
  s.distance -= collider_.thickness;
  return s;
}

SurfacePoint ColliderView::closest(const Vec3& p, QueryMemory& near) const { return on_layer(shape_.closest(p, near)); }

std::optional<SurfacePoint> ColliderView::closest_within(const Vec3& p, double most, QueryMemory& near) const {
  const std::optional<SurfacePoint> found = shape_.closest_within(p, most + collider_.thickness, near);
  return found ? std::optional(on_layer(*found)) : std::nullopt;
}

// Returns which share of a way, from one time in the step to another, leads to the layer; nothing when it is not met,
// or not within the share `latest`. Steps as long as the distance never overshoot (Hart 1996, "Sphere tracing"); a
// shape made of triangles is asked where the way itself enters it.
std::optional<double> ColliderView::meets(const Way& way, double from, double to, double field_at_start,
                                          QueryMemory& near, double latest) const {
  const double length = way.length;
  const double close = 1e-9 * (length + std::abs(field_at_start));
  const Vec3 start = from > 0 ? way.b : way.a, end = from > 0 ? way.a : way.b;
  const bool straight = !bends_;
  if (straight && shape_.knows_entries() && collider_.thickness <= 0) return shape_.entry(start, end);
  double gone = 0, field = field_at_start;
  for (int march = 0; march < most_marches_of_ray && field > close; ++march) {
    gone += clear(field);
    if (gone >= length || gone > latest * length) return std::nullopt;
    const double share = gone / length;
    field = distance(straight ? Vec3(start + share * (end - start)) : at(way, from + share * (to - from)), near);
  }
  return length > 0 ? gone / length : 0.0;
}

double ColliderView::most_moved(const Vec3& center, double radius) const {
  const double turn = Eigen::AngleAxisd(end_.linear() * start_.linear().transpose()).angle();
  if (surface_ == nullptr) return (carried(center) - center).norm() + turn * radius;
  const double deformed = shape_.most_carried(*surface_);
  return (end_ * (to_start_ * center) - center).norm() + turn * (radius + deformed) + deformed;
}

double ColliderView::least_distance(const Vec3& center, double radius, QueryMemory& near) const {
  if (surface_ == nullptr) return distance(at_start(center), near) - uncertain(radius);
  // Points of the ball may be carried apart, but none further than this.
  return distance(to_end_ * center, near) - uncertain(radius + most_moved(center, radius));
}

std::optional<ColliderView::Entry> ColliderView::entry(const Way& way, double field_at_a, QueryMemory& near,
                                                       double latest) const {
  if (field_at_a <= 0) return Entry{closest(way.a, near), 0};
  const std::optional<double> share = meets(way, 0, 1, field_at_a, near, latest);
  if (!share) return std::nullopt;
  return Entry{closest(at(way, *share), near), *share};
}

// Tells whether a way may lead through triangles, not just through the layer around them.
bool ColliderView::leads_through(const Way& way, double field_at_a, double field_at_b) const {
  const double to_a = field_at_a + collider_.thickness, to_b = field_at_b + collider_.thickness;
  if (to_a <= 0 || to_b <= 0) return true;
  if (to_a + to_b > (1 + 1e-9) * way.length) return false;  // the balls without triangles around both ends cover it
  return bends_ || shape_.entry(way.a, way.b).has_value();
}

std::optional<SurfacePoint> ColliderView::holding(const Way& way, double field_at_a, double reach,
                                                  QueryMemory& near) const {
  // The balls around both ends contain the whole way, so that it meets nothing where both are empty.
  const double around = std::max(reach, way.length - field_at_a);
  if (field_at_a > 0 && certain_distance(way.b, near) > around) return std::nullopt;
  const std::optional<SurfacePoint> nearest =
      field_at_a > 0 && knows_bounds() ? closest_within(way.b, (1 + 1e-6) * around, near) : closest(way.b, near);
  if (!nearest) return std::nullopt;
  const SurfacePoint& here = *nearest;
  // The way leads straight onto the side that is closest: the usual case, which needs no ray.
  const bool entered_now = !bends_ && here.distance < 0 && field_at_a > 0;
  if (entered_now && (way.a - here.point).dot(here.normal) >= 0) return here;
  // A short way leads through nothing, but it may have begun before the other side of an edge.
  if (short_way(way.length + std::max(0.0, -field_at_a)) &&
      !(entered_now && !on_one_side(closest(way.a, near).normal, here.normal)))
    return here.distance < reach ? std::optional(here) : std::nullopt;
  if (knows_bounds() && !leads_through(way, field_at_a, here.distance))
    return here.distance < reach ? std::optional(here) : std::nullopt;
  const std::optional<Entry> entered = entry(way, field_at_a, near);
  if (!entered) return here.distance < reach ? std::optional(here) : std::nullopt;
  if (here.distance < 0) return is_held_by(entered->surface, here, way, field_at_a > 0) ? entered->surface : here;
  // The vertex is outside again. A way that cuts a corner may pass; one that leaves on the far side may not.
  const std::optional<double> back = meets(way, 1, 0, here.distance, near);
  const SurfacePoint left = back ? closest(at(way, 1 - *back), near) : here;
  if (are_opposite(left.normal, entered->surface.normal)) return entered->surface;
  return here.distance < reach ? std::optional(here) : std::nullopt;
}

}  // namespace supple
