#include "sim/contact/way_out.h"

#include <algorithm>
#include <cmath>

namespace supple {
namespace {

constexpr std::size_t most_asked = 64;    // points whose normals are tried as directions
constexpr int most_marches_inside = 100;  // steps of a march through the inside of a collider
constexpr int most_rounds = 6;            // rounds of going further because other points have come inside

// Adds a direction, unless one is there that differs by less than 15 degrees.
void add_direction(const Vec3& v, std::vector<Vec3>& directions) {
  if (v.norm() < 1e-6) return;
  const Vec3 unit = v.normalized();
  for (const Vec3& known : directions) {
    if (known.dot(unit) > 0.966) return;
  }
  directions.push_back(unit);
}

struct Point {
  Vec3 place;
  double distance;  // to the obstacles, negative inside [m]
};

std::vector<Vec3> directions_from(const Obstacles& obstacles, const std::vector<Point>& inside) {
  std::vector<Vec3> directions;
  Vec3 mean = Vec3::Zero();
  std::vector<Vec3> normals;
  const std::size_t every = (inside.size() + most_asked - 1) / most_asked;
  for (std::size_t i = 0; i < inside.size(); i += every) {
    normals.push_back(obstacles.normal(inside[i].place));
    mean -= inside[i].distance * normals.back();
  }
  add_direction(mean, directions);
  for (const Vec3& normal : normals) add_direction(normal, directions);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      add_direction(sign * Vec3::Unit(axis), directions);
      for (const Eigen::Isometry3d& pose : obstacles.poses()) add_direction(sign * pose.linear().col(axis), directions);
    }
  }
  return directions;
}

// Returns how far points that are inside must go, beyond `gone`, until they are out; more than `furthest` when they are
// not out within it.
double further(const Obstacles& obstacles, const std::vector<Point>& points, const Vec3& direction, double gone,
               double tolerated, double furthest) {
  double most = gone;
  for (const Point& p : points) {
    if (gone < obstacles.clear(std::max(0.0, p.distance))) continue;
    double at = gone, field = at > 0 ? obstacles.distance(p.place + at * direction) : p.distance;
    if (field >= -tolerated) continue;
    int march = 0;
    for (; field < 0 && march < most_marches_inside && at <= furthest; ++march) {
      at += std::max(obstacles.clear(field), 1e-6 * furthest);
      field = obstacles.distance(p.place + at * direction);
    }
    if (field < 0) return 2 * furthest;
    most = std::max(most, at);
    if (most > furthest) return most;
  }
  return most;
}

}  // namespace

Obstacles::Obstacles(const std::vector<Collider>& colliders, std::vector<Eigen::Isometry3d> poses)
    : colliders_(colliders), poses_(std::move(poses)) {
  for (const Eigen::Isometry3d& pose : poses_) to_local_.push_back(pose.inverse());
  for (const Collider& collider : colliders_) certainty_ = std::min(certainty_, collider.shape.certainty());
}

double Obstacles::distance(std::size_t c, const Vec3& point) const {
  return colliders_[c].shape.distance(to_local_[c] * point) - colliders_[c].thickness;
}

double Obstacles::distance(const Vec3& point) const {
  double least = 1e300;
  for (std::size_t c = 0; c < colliders_.size(); ++c) least = std::min(least, distance(c, point));
  return least;
}

Vec3 Obstacles::normal(const Vec3& point) const {
  std::size_t deepest = 0;
  for (std::size_t c = 1; c < colliders_.size(); ++c) {
    if (distance(c, point) < distance(deepest, point)) deepest = c;
  }
  return poses_[deepest].linear() * colliders_[deepest].shape.closest(to_local_[deepest] * point).normal;
}

std::optional<WayOut> way_out(const Obstacles& obstacles, const Positions& points, double tolerated, double furthest) {
  std::vector<Point> all, inside;
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    all.push_back({points.row(v), obstacles.distance(points.row(v))});
    if (all.back().distance < -tolerated) inside.push_back(all.back());
  }
  if (inside.empty()) return WayOut{};
  std::vector<WayOut> ways;
  double best = furthest;
  for (const Vec3& direction : directions_from(obstacles, inside)) {
    const double distance = further(obstacles, inside, direction, 0, tolerated, furthest);
    if (distance <= furthest) ways.push_back({direction, distance});
  }
  std::stable_sort(ways.begin(), ways.end(), [](const WayOut& a, const WayOut& b) { return a.distance < b.distance; });
  std::optional<WayOut> found;
  for (WayOut way : ways) {
    if (way.distance >= best) break;
    for (int round = 0; round < most_rounds; ++round) {
      const double gone = way.distance;
      way.distance = further(obstacles, all, way.direction, gone, tolerated, best);
      if (way.distance > best) break;
      if (way.distance > gone) continue;
      found = way;
      best = way.distance;
      break;
    }
  }
  return found;
}

}  // namespace supple
