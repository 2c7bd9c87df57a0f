#include "app/bench/small_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "output/files/png_file.h"

namespace supple {
namespace {

constexpr std::uint8_t paper = 250;

// Returns the axes of the view as rows: to the right, up, and towards the eye.
Mat3 view_axes() {
  const Vec3 eye = Vec3(0.5, 0.35, 1).normalized(), right = Vec3(0, 1, 0).cross(eye).normalized();
  Mat3 axes;
  axes << right.transpose(), eye.cross(right).transpose(), eye.transpose();
  return axes;
}

}  // namespace

PanelPicture::PanelPicture(int panels, int edge)
    : panels_(panels),
      edge_(edge),
      rgb_(std::size_t(3) * panels * edge * edge, paper),
      depth_(std::size_t(panels) * edge * edge, -std::numeric_limits<float>::infinity()) {}

// Fills a triangle whose corners are in pixels of the panel, with depths that grow towards the eye.
void PanelPicture::fill(int panel, const Eigen::Vector3d corners[3], const std::uint8_t color[3]) {
  const Eigen::Vector3d &a = corners[0], &b = corners[1], &c = corners[2];
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (std::abs(area) < 1e-12) return;
  const auto first = [&](int axis) {
    return int(std::clamp(std::floor(std::min({a[axis], b[axis], c[axis]})), 0.0, edge_ - 1.0));
  };
  const auto last = [&](int axis) {
    return int(std::clamp(std::ceil(std::max({a[axis], b[axis], c[axis]})), 0.0, edge_ - 1.0));
  };
  for (int y = first(1); y <= last(1); ++y) {
    for (int x = first(0); x <= last(0); ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double u = ((b.x() - px) * (c.y() - py) - (b.y() - py) * (c.x() - px)) / area;
      const double v = ((c.x() - px) * (a.y() - py) - (c.y() - py) * (a.x() - px)) / area;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const auto depth = float(u * a.z() + v * b.z() + (1 - u - v) * c.z());
      const std::size_t at = std::size_t(y) * panels_ * edge_ + std::size_t(panel) * edge_ + x;
      if (depth <= depth_[at]) continue;
      depth_[at] = depth;
      std::copy(color, color + 3, &rgb_[3 * at]);
    }
  }
}

void PanelPicture::draw(int panel, const Positions& x, const Triangles& surface, const Bounds& view) {
  if (!x.allFinite() || view.empty()) return;
  const Mat3 axes = view_axes();
  Bounds seen;  // of the view's corners, along the axes
  for (int corner = 0; corner < 8; ++corner) {
    seen.include(axes * Vec3((corner & 1) != 0 ? view.upper.x() : view.lower.x(),
                             (corner & 2) != 0 ? view.upper.y() : view.lower.y(),
                             (corner & 4) != 0 ? view.upper.z() : view.lower.z()));
  }
  const double scale = 0.92 * edge_ / std::max({seen.extent().x(), seen.extent().y(), 1e-300});
  const Vec3 light = Vec3(0.3, 0.6, 0.75).normalized();
  for (Eigen::Index t = 0; t < surface.rows(); ++t) {
    Eigen::Vector3d corners[3];
    for (int c = 0; c < 3; ++c) {
      corners[c] = scale * (axes * x.row(surface(t, c)).transpose() - seen.center());
      corners[c].x() = 0.5 * edge_ + corners[c].x();
      corners[c].y() = 0.5 * edge_ - corners[c].y();
    }
    // y points down here, so the normal towards the eye has the other sign.
    Eigen::Vector3d normal = -(corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() > 0) normal.normalize();
    const bool behind = normal.z() < 0;
    const Vec3 up(normal.x(), -normal.y(), std::abs(normal.z()));
    const double shade = 0.45 + 0.55 * std::max(0.0, up.dot(light));
    const double base[3] = {behind ? 0.85 : 0.36, behind ? 0.25 : 0.58, behind ? 0.2 : 0.8};
    std::uint8_t color[3];
    for (int k = 0; k < 3; ++k) color[k] = std::uint8_t(std::clamp(255 * shade * base[k], 0.0, 255.0));
    fill(panel, corners, color);
  }
}

void PanelPicture::write(const std::filesystem::path& file) const { write_png(file, panels_ * edge_, edge_, rgb_); }

}  // namespace supple
