#include "live/live_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double steepest = 89 * degree;  // of the elevation, as cameras of scenes have it

struct Axes {
  Vec3 right, up;  // of the picture, of length one
};

Axes axes_of(const Camera& camera) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitY()).normalized();
  return {right, right.cross(forward)};
}

}  // namespace

Camera& LiveView::own() {
  if (!own_) own_ = seen_;
  return *own_;
}

void LiveView::orbit(const Eigen::Vector2d& degrees) {
  Camera& camera = own();
  const Vec3 from = camera.eye - camera.target;
  const double distance = from.norm();
  const double azimuth = std::atan2(from.x(), from.z()) + degree * degrees.x();
  const double elevation =
      std::clamp(std::asin(std::clamp(from.y() / distance, -1.0, 1.0)) + degree * degrees.y(), -steepest, steepest);
  camera.eye = camera.target + distance * Vec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                               std::cos(azimuth) * std::cos(elevation));
}

void LiveView::pan(const Eigen::Vector2d& shares) {
  Camera& camera = own();
  const double height = 2 * (camera.eye - camera.target).norm() * std::tan(0.5 * degree * camera.fov_deg);
  const auto [right, up] = axes_of(camera);
  const Vec3 move = -height * (shares.x() * right + shares.y() * up);
  constexpr double furthest = 1e4;  // [m]
  if (!((camera.target + move).norm() < furthest)) return;
  camera.eye += move;
  camera.target += move;
}

void LiveView::zoom(double factor) {
  Camera& camera = own();
  const Vec3 from = camera.eye - camera.target;
  constexpr double nearest = 1e-3, furthest = 1e4;  // [m]
  camera.eye = camera.target + from * (std::clamp(from.norm() / factor, nearest, furthest) / from.norm());
}

Camera LiveView::see(const DrawList& list) {
  const Vec3 moved = list.followed ? list.followed->moved : Vec3(Vec3::Zero());
  if (own_) {
    own_->eye += moved - moved_;
    own_->target += moved - moved_;
  }
  moved_ = moved;
  seen_ = own_.value_or(list.camera);
  return seen_;
}

}  // namespace supple
