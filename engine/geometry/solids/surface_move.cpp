#include "geometry/solids/surface_move.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

using MoveCorners = std::array<Vec3, 3>;

MoveCorners corners_of(const TriangleSolid& solid, Eigen::Index triangle) {
  MoveCorners corners;
  for (int k = 0; k < 3; ++k)
    corners[std::size_t(k)] = solid.surface().points.row(solid.surface().triangles(triangle, k)).transpose();
  return corners;
}

// Returns three orthonormal axes that turn with a triangle. A triangle without area has none, and does not turn.
Mat3 frame_of(const MoveCorners& corners, bool& has_area) {
  const Vec3 along = corners[1] - corners[0], normal = along.cross(corners[2] - corners[0]);
  const double length = along.norm(), area = normal.norm();
  has_area = area > 1e-12 * length * length;
  Mat3 frame = Mat3::Identity();
  if (!has_area) return frame;
  frame.col(0) = along / length;
  frame.col(2) = normal / area;
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

Mat3 turn_between(const MoveCorners& from, const MoveCorners& to) {
  bool has_start = false, has_end = false;
  const Mat3 start = frame_of(from, has_start), end = frame_of(to, has_end);
  return has_start && has_end ? Mat3(end * start.transpose()) : Mat3(Mat3::Identity());
}

Vec3 place_in(const MoveCorners& corners, const SurfacePlace& place) {
  return corners[0] + place.v * (corners[1] - corners[0]) + place.w * (corners[2] - corners[0]);
}

}  // namespace

SurfaceMove::SurfaceMove(std::shared_ptr<const TriangleSolid> start, std::shared_ptr<const TriangleSolid> end,
                         double reach)
    : start_(std::move(start)), end_(std::move(end)) {
  const Positions &from = start_->surface().points, &to = end_->surface().points;
  SUPPLE_CHECK(from.rows(), ==, to.rows());
  if (start_ == end_) return;
  most_ = std::sqrt((to - from).rowwise().squaredNorm().maxCoeff());
  for (Eigen::Index t = 0; most_ > 0 && t < start_->surface().triangles.rows(); ++t) {
    const Mat3 turn = turn_between(corners_of(*start_, t), corners_of(*end_, t));
    turn_ = std::max(turn_, (turn - Mat3::Identity()).norm() / std::sqrt(2.0));
  }
  // Eight times the way of the surface leaves the places that it meets in a step well within.
  constexpr double ways = 8;
  whole_ = std::max(reach, ways * most_);
}

Vec3 SurfaceMove::carried(const Vec3& p) const {
  if (most_ <= 0) return p;
  const Bounds& box = start_->bounds();
  if ((p - p.cwiseMax(box.lower).cwiseMin(box.upper)).norm() >= 2 * whole_) return p;
  const SurfacePlace place = start_->place(p);
  const MoveCorners from = corners_of(*start_, place.triangle), to = corners_of(*end_, place.triangle);
  const Vec3 foot = place_in(from, place), offset = p - foot;
  const double share = std::clamp(2 - offset.norm() / whole_, 0.0, 1.0);
  const Vec3 there = place_in(to, place) + turn_between(from, to) * offset;
  return share >= 1 ? there : Vec3(p + share * (there - p));
}

Eigen::Isometry3d SurfaceMove::motion_near(const Vec3& p) const {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (most_ <= 0) return motion;
  const SurfacePlace place = start_->place(p);
  const MoveCorners from = corners_of(*start_, place.triangle), to = corners_of(*end_, place.triangle);
  motion.linear() = turn_between(from, to);
  motion.translation() = place_in(to, place) - motion.linear() * place_in(from, place);
  return motion;
}

}  // namespace supple
