#include "render/stage_cover.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/ground_occlusion.h"
#include "render/projection.h"
#include "render/view.h"

namespace supple {
namespace {

// Includes the ground below bodies that hang in the air, because their shadows fall there.
Bounds stage_bounds(const Stage& stage) {
  Bounds box = framed_at_start(stage);
  if (!box.empty()) box.lower.y() = std::min(0.0, box.lower.y());
  return box;
}

double largest_of(const Stage& stage) {
  double largest = 1e-6;
  for (const DrawMesh& mesh : stage.meshes)
    if (mesh.framed) largest = std::max(largest, mesh.rest.diagonal());
  return largest;
}

Bounds bounds_now(const std::vector<float>& points) {
  Bounds box;
  float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], points[i + k]);
      high[k] = std::max(high[k], points[i + k]);
    }
  }
  if (points.empty()) return box;
  box.lower = Vec3(low[0], low[1], low[2]);
  box.upper = Vec3(high[0], high[1], high[2]);
  return box;
}

// Returns the next larger size of a ladder whose steps are a factor of the square root of two, so that sizes that
// change little stay.
double next_size(double needed, double first) {
  if (needed <= first) return first;
  return first * std::exp2(0.5 * std::ceil(2 * std::log2(needed / first)));
}

// A map is never coarser than this many times what it is at rest; what is then not covered has no shadow.
constexpr double coarsest = 8;

double horizontal(const Vec3& v) { return std::hypot(v.x(), v.z()); }

}  // namespace

StageCover::StageCover(const Stage& stage, const Vec3& to_light)
    : aspect_(static_cast<double>(stage.width) / stage.height),
      bounds_(stage_bounds(stage)),
      largest_body_(largest_of(stage)),
      to_light_(to_light) {
  const Eigen::Matrix4d look = look_at(bounds_.center() + to_light_, bounds_.center()).cast<double>();
  right_ = look.block<1, 3>(0, 0).transpose();
  up_ = look.block<1, 3>(1, 0).transpose();
  Bounds lit = bounds_;
  for (const Vec3& point : stage.motion) lit.include(point);
  rest_.light_center = lit.center();
  rest_.light_radius = 0.5 * lit.diagonal() + largest_body_;
  rest_.shadow_center = rest_.shade_center = bounds_.center();
  rest_.shadow_radius = 0.5 * bounds_.diagonal() + 0.45 * largest_body_;
  rest_.shade_extent = std::max(bounds_.extent().x(), bounds_.extent().z()) + 2.5 * largest_body_;
}

// Tells whether some of a ball may be in the picture, by the four planes through the eye.
bool StageCover::is_seen(const Camera& camera, const Ball& ball) const {
  const Eigen::Matrix4d to_eye = look_at(camera.eye, camera.target).cast<double>();
  const Vec3 from_eye = ball.center - camera.eye;
  const double x = to_eye.block<1, 3>(0, 0).dot(from_eye), y = to_eye.block<1, 3>(1, 0).dot(from_eye),
               ahead = -to_eye.block<1, 3>(2, 0).dot(from_eye);
  const double high = std::tan(camera.fov_deg * std::numbers::pi / 360), wide = high * aspect_;
  return std::abs(x) - wide * ahead <= ball.radius * std::hypot(1, wide) &&
         std::abs(y) - high * ahead <= ball.radius * std::hypot(1, high);
}

// Returns a ball around the shadow on the ground, which a low sun makes long.
StageCover::Ball StageCover::shadow_of(const Ball& ball) const {
  const Vec3 there = ball.center - std::max(0.0, ball.center.y()) / to_light_.y() * to_light_;
  return {there, ball.radius / to_light_.y()};
}

StageCover::Frame StageCover::at(const std::vector<DrawMesh>& meshes, const DrawList& list) const {
  Frame frame = rest_;
  std::vector<Ball> all, seen;
  for (std::size_t m = 0; m < list.positions.size() && m < meshes.size(); ++m) {
    if (!meshes[m].framed || meshes[m].ghost) continue;
    const Bounds box = bounds_now(list.positions[m]);
    if (box.empty() || !box.lower.allFinite() || !box.upper.allFinite()) continue;
    const Ball ball{box.center(), 0.5 * box.diagonal()};
    all.push_back(ball);
    if (is_seen(list.camera, ball) || is_seen(list.camera, shadow_of(ball))) seen.push_back(ball);
  }
  follow_with_light(all, list, frame);
  follow_with_shadow(seen, frame);
  follow_with_shade(seen, frame);
  return frame;
}

// Moves the ground's lit disc along with what the camera follows, which stays near the disc's middle. Where the camera
// follows nothing, the disc grows for one body after the other, so far that it holds the body and what it held before;
// it stops once it is `coarsest` times as large as at rest.
void StageCover::follow_with_light(const std::vector<Ball>& balls, const DrawList& list, Frame& frame) const {
  constexpr double slack = 0.2;  // of the radius, by which what is followed moves before the light does
  if (list.followed) {
    const Vec3& moved = list.followed->moved;
    const double away = horizontal(moved), free = slack * rest_.light_radius;
    if (away > free) frame.light_center += (1 - free / away) * Vec3(moved.x(), 0, moved.z());
    return;
  }
  for (const Ball& ball : balls) {
    const Vec3 from = ball.center - frame.light_center;
    const double beyond = horizontal(from) + ball.radius - frame.light_radius;
    if (beyond <= 0 || frame.light_radius > coarsest * rest_.light_radius) continue;
    if (horizontal(from) + frame.light_radius <= ball.radius) {  // the ball is all around the disc
      frame.light_radius = ball.radius;
      frame.light_center += Vec3(from.x(), 0, from.z());
      continue;
    }
    frame.light_radius += 0.5 * beyond;
    frame.light_center += 0.5 * beyond / horizontal(from) * Vec3(from.x(), 0, from.z());
  }
}

// Moves the shadow map, and makes it larger, where bodies leave it. The map lies in the plane of right_ and up_; its
// texels stay on the grid that they have at rest, as long as its size stays.
void StageCover::follow_with_shadow(const std::vector<Ball>& balls, Frame& frame) const {
  const auto in_map = [&](const Vec3& p) { return Vec3(right_.dot(p), up_.dot(p), to_light_.dot(p)); };
  const Vec3 center = in_map(rest_.shadow_center);
  Bounds needed;
  for (const Ball& ball : balls) {
    Bounds with = needed;
    for (const double sign : {-1.0, 1.0}) with.include(in_map(ball.center) + Vec3::Constant(sign * ball.radius));
    if (0.5 * with.extent().maxCoeff() <= coarsest * rest_.shadow_radius) needed = with;
  }
  if (needed.empty()) return;
  const double radius = rest_.shadow_radius;
  if ((needed.lower - center).minCoeff() >= -radius && (needed.upper - center).maxCoeff() <= radius) return;
  constexpr double steps = 16;  // of the map's radius, by which it moves: a whole number of texels
  const double border = 0.2 * largest_body_;
  frame.shadow_radius = next_size(steps / (steps - 1) * (0.5 * needed.extent().maxCoeff() + border), radius);
  const double step = frame.shadow_radius / steps;
  const Vec3 moved = needed.center() - center;
  const auto whole = [step](double way) { return step * std::round(way / step); };
  frame.shadow_center += whole(moved.x()) * right_ + whole(moved.y()) * up_ + whole(moved.z()) * to_light_;
}

void StageCover::follow_with_shade(const std::vector<Ball>& balls, Frame& frame) const {
  const double margin = 0.6 * largest_body_;
  Bounds needed;
  for (const Ball& ball : balls) {
    if (ball.center.y() - ball.radius > margin) continue;  // too high to darken the ground
    Bounds with = needed;
    for (const double sign : {-1.0, 1.0}) {
      const double x = ball.center.x() + sign * ball.radius, z = ball.center.z() + sign * ball.radius;
      with.include(Vec3(x, 0, z));
    }
    if (with.extent().maxCoeff() <= coarsest * rest_.shade_extent) needed = with;
  }
  if (needed.empty()) return;
  const Vec3 low = needed.lower - rest_.shade_center, high = needed.upper - rest_.shade_center;
  const double half = 0.5 * rest_.shade_extent;
  if (std::min(low.x(), low.z()) >= -half && std::max(high.x(), high.z()) <= half) return;
  frame.shade_extent = next_size(needed.extent().maxCoeff() + 2 * margin, rest_.shade_extent);
  const double cell = frame.shade_extent / GroundOcclusion::cells;
  const auto whole = [cell](double way) { return cell * std::round(way / cell); };
  const Vec3 moved = needed.center() - rest_.shade_center;
  frame.shade_center += Vec3(whole(moved.x()), 0, whole(moved.z()));
}

}  // namespace supple
