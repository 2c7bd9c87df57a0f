#include "render/projection.h"

#include "base/convex_hull.h"
#include "render/view.h"

namespace supple {

Projection::Projection(const Camera& camera, const Bounds& around, int width, int height)
    : view_(view_matrix(camera, static_cast<double>(width) / height, around.center(), around.diagonal() + 1)),
      width_(width),
      height_(height) {}

std::optional<Eigen::Vector2d> Projection::operator()(const Vec3& point) const {
  const Eigen::Vector4f clip = view_ * point.homogeneous().cast<float>();
  if (clip.w() <= 0) return std::nullopt;
  return Eigen::Vector2d((clip.x() / clip.w() * 0.5 + 0.5) * width_, (0.5 - clip.y() / clip.w() * 0.5) * height_);
}

Outline Projection::outline(const Bounds& box) const {
  std::vector<Eigen::Vector2d> corners;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 point;
    for (int k = 0; k < 3; ++k) point[k] = (corner >> k & 1) != 0 ? box.upper[k] : box.lower[k];
    const std::optional<Eigen::Vector2d> pixel = (*this)(point);
    if (!pixel) return {};
    corners.push_back(*pixel);
  }
  return hull_of(corners);
}

Bounds framed_at_start(const Stage& stage) {
  Bounds around;
  for (const DrawMesh& mesh : stage.meshes) {
    if (!mesh.framed) continue;
    around.include(mesh.rest.lower);
    around.include(mesh.rest.upper);
  }
  return around;
}

}  // namespace supple
