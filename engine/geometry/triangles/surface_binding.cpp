#include "geometry/triangles/surface_binding.h"

#include <limits>

#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

// Returns unit axes that turn with a triangle, as columns: along its first edge, in its plane, and its normal. A
// triangle without area has those of the world.
Mat3 axes_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  if (!(normal.norm() > 0)) return Mat3::Identity();
  Mat3 axes;
  axes.col(0) = (b - a).normalized();
  axes.col(2) = normal.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

}  // namespace

SurfaceBinding::SurfaceBinding(const TriMesh& surface, const Positions& points) {
  const TriangleSoup soup(surface);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 point = points.row(i);
    const TriangleSoup::Near near = soup.closest(point, std::numeric_limits<double>::infinity(), Vec3::Zero());
    Bound bound;
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      bound.corner[k] = surface.triangles(near.triangle, Eigen::Index(k));
      corner[k] = surface.points.row(bound.corner[k]);
    }
    bound.weights = weights_in_triangle(near.point, corner[0], corner[1], corner[2]);
    bound.offset = axes_of(corner[0], corner[1], corner[2]).transpose() * (point - near.point);
    bound_.push_back(bound);
  }
}

Positions SurfaceBinding::points_at(const Positions& vertices) const {
  Positions points(std::ssize(bound_), 3);
  for (std::size_t i = 0; i < bound_.size(); ++i) {
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = vertices.row(bound_[i].corner[k]);
    Vec3 place = axes_of(corner[0], corner[1], corner[2]) * bound_[i].offset;
    for (std::size_t k = 0; k < 3; ++k) place += bound_[i].weights[Eigen::Index(k)] * corner[k];
    points.row(Eigen::Index(i)) = place.transpose();
  }
  return points;
}

}  // namespace supple
