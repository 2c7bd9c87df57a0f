#include "render/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

Eigen::Matrix4f perspective(double fov_deg, double aspect, double near, double far) {
  const double f = 1 / std::tan(fov_deg * std::numbers::pi / 360);
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m(0, 0) = static_cast<float>(f / aspect);
  m(1, 1) = static_cast<float>(f);
  m(2, 2) = static_cast<float>((far + near) / (near - far));
  m(2, 3) = static_cast<float>(2 * far * near / (near - far));
  m(3, 2) = -1;
  return m;
}

}  // namespace

Eigen::Matrix4f look_at(const Vec3& eye, const Vec3& target) {
  const Vec3 back = (eye - target).normalized();
  const Vec3 up = std::abs(back.y()) > 0.999 ? Vec3::UnitZ() : Vec3::UnitY();
  const Vec3 right = up.cross(back).normalized();
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = back.cross(right).transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * eye;
  return m.cast<float>();
}

namespace {

// Holds the distances from the eye between which things are visible [m].
struct Depths {
  double near, far;
};

Depths depths_of(const Camera& camera, const Vec3& center, double reach) {
  const double nearest = 0.02 * std::min(reach, (camera.eye - camera.target).norm());
  return {nearest, (camera.eye - center).norm() + 60 * reach};
}

}  // namespace

Eigen::Matrix4f view_matrix(const Camera& camera, double aspect, const Vec3& center, double reach) {
  const Depths depths = depths_of(camera, center, reach);
  Eigen::Matrix4f projection = perspective(camera.fov_deg, aspect, depths.near, depths.far);
  for (int k = 0; k < 2; ++k) projection(k, 2) -= projection(k, k) * static_cast<float>(camera.shift[k]);
  return projection * look_at(camera.eye, camera.target);
}

double nearest_seen(const Camera& camera, const Vec3& center, double reach) {
  return depths_of(camera, center, reach).near;
}

Rays rays_through(const Camera& camera, int width, int height) {
  const Eigen::Matrix4d to_eye = look_at(camera.eye, camera.target).cast<double>();
  const Vec3 right = to_eye.block<1, 3>(0, 0), up = to_eye.block<1, 3>(1, 0), back = to_eye.block<1, 3>(2, 0);
  const double pixel = 2 * std::tan(camera.fov_deg * std::numbers::pi / 360) / height;
  const Vec3 corner = -back - 0.5 * pixel * (width * right + height * up);
  return {corner - camera.shift.x() * right - camera.shift.y() * up, pixel * right, pixel * up};
}

Camera framing(const Bounds& box, const Vec3& direction, double fov_deg, double margin, double aspect) {
  Camera camera;
  camera.fov_deg = fov_deg;
  camera.target = box.center() - Vec3(0, 0.06 * box.extent().y(), 0);  // captions stand below
  const double high = std::tan(fov_deg * std::numbers::pi / 360), wide = high * aspect;
  const Vec3 right = Vec3::UnitY().cross(direction).normalized(), up = direction.cross(right);
  // A corner is in view when its distance from the axis is at most its depth times the tangent of half the angle.
  double distance = 0;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1 ? box.upper.x() : box.lower.x(), c & 2 ? box.upper.y() : box.lower.y(),
                      c & 4 ? box.upper.z() : box.lower.z());
    const Vec3 p = corner - camera.target;
    const double depth = margin * std::max(std::abs(p.dot(right)) / wide, std::abs(p.dot(up)) / high);
    distance = std::max(distance, depth + p.dot(direction));
  }
  camera.eye = camera.target + distance * direction;
  return camera;
}

namespace {

// Finds where the eye may be so that all points lie between two opposite borders of the picture, which are two planes
// through the eye. Its place along `side` is at least above_ - high_ b and at most low_ b - below_, where b is its
// place along `back`.
class SideLimits {
 public:
  // side: the direction to the right or up in the picture. back: the direction from what is seen to the eye. low, high:
  // tangents of the angles to the border on the left or below, and to the one on the right or above.
  SideLimits(std::span<const Vec3> points, const Vec3& side, const Vec3& back, double low, double high)
      : low_(low), high_(high) {
    for (const Vec3& p : points) {
      above_ = std::max(above_, p.dot(side) + high * p.dot(back));
      below_ = std::max(below_, low * p.dot(back) - p.dot(side));
    }
  }
  // Returns the least place of the eye along `back`.
  double nearest() const { return (above_ + below_) / (low_ + high_); }
  // Returns the place of the eye along the side, in the middle of where it may be, from a place along `back`.
  double middle(double back) const { return 0.5 * (above_ - high_ * back + low_ * back - below_); }

 private:
  double low_, high_;
  double above_ = -1e300, below_ = -1e300;
};

}  // namespace

Camera framing(std::span<const Vec3> points, const Vec3& direction, double fov_deg, double margin, double aspect,
               double kept_below) {
  const double high = std::tan(fov_deg * std::numbers::pi / 360) / margin, wide = high * aspect;
  const Vec3 right = Vec3::UnitY().cross(direction).normalized(), up = direction.cross(right);
  const SideLimits across(points, right, direction, wide, wide);
  const SideLimits upright(points, up, direction, high * (1 - 2 * kept_below), high);
  const double back = std::max(across.nearest(), upright.nearest());
  Camera camera;
  camera.fov_deg = fov_deg;
  camera.eye = back * direction + across.middle(back) * right + upright.middle(back) * up;
  double depth = 0;
  for (const Vec3& p : points) depth += (camera.eye - p).dot(direction) / static_cast<double>(points.size());
  camera.target = camera.eye - depth * direction;
  return camera;
}

namespace {

// Gives vertices with the same number the sum of their normals.
void unite_normals(const std::vector<std::uint32_t>& smooth, float* normals) {
  std::vector<std::array<float, 3>> sums(1 + std::size_t(*std::ranges::max_element(smooth)));
  for (std::size_t v = 0; v < smooth.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) sums[smooth[v]][k] += normals[4 * v + k];
  for (std::size_t v = 0; v < smooth.size(); ++v) std::copy_n(sums[smooth[v]].data(), 3, normals + 4 * v);
}

}  // namespace

void compute_normals(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
                     const std::vector<std::uint32_t>& smooth, float* normals) {
  const std::size_t vertices = positions.size() / 3;
  std::fill_n(normals, 4 * vertices, 0.0f);
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const float* a = &positions[3 * triangles[t]];
    const float* b = &positions[3 * triangles[t + 1]];
    const float* c = &positions[3 * triangles[t + 2]];
    const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (int corner = 0; corner < 3; ++corner) {
      float* sum = &normals[4 * triangles[t + corner]];
      for (int k = 0; k < 3; ++k) sum[k] += n[k];
    }
  }
  if (!smooth.empty()) unite_normals(smooth, normals);
  for (std::size_t i = 0; i < 4 * vertices; i += 4) {
    float* n = normals + i;
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 0) {
      for (int k = 0; k < 3; ++k) n[k] /= length;
    }
  }
}

}  // namespace supple
