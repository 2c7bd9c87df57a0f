#include "geometry/triangles/refine_surface.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "geometry/triangles/split_triangle.h"

namespace supple {
namespace {

// Halves each edge that is too long, once.
class Pass {
 public:
  Pass(std::vector<Vec3>& points, std::vector<std::array<std::int32_t, 2>>& ends, double longest)
      : points_(points), ends_(ends), longest_(longest) {}

  // Appends the parts of a triangle: the triangle itself where no edge is too long.
  void split(const CornerNumbers& corners, std::vector<CornerNumbers>& parts) {
    std::array<std::int32_t, 3> middle;
    for (std::size_t k = 0; k < 3; ++k) middle[k] = middle_of(corners[k], corners[(k + 1) % 3]);
    split_triangle(
        corners, middle, [this](std::int32_t a, std::int32_t b) { return length2(a, b); }, parts);
  }

 private:
  double length2(std::int32_t a, std::int32_t b) const {
    return (points_[std::size_t(a)] - points_[std::size_t(b)]).squaredNorm();
  }

  std::int32_t middle_of(std::int32_t a, std::int32_t b) {
    if (length2(a, b) <= longest_ * longest_) return -1;
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t edge = std::uint64_t(low) << 32 | std::uint64_t(high);
    const auto [at, added] = middles_.try_emplace(edge, static_cast<std::int32_t>(points_.size()));
    if (added) {
      points_.emplace_back(0.5 * (points_[std::size_t(low)] + points_[std::size_t(high)]));
      ends_.push_back({low, high});
    }
    return at->second;
  }

  std::vector<Vec3>& points_;
  std::vector<std::array<std::int32_t, 2>>& ends_;
  const double longest_;
  std::unordered_map<std::uint64_t, std::int32_t> middles_;  // by edge
};

}  // namespace

RefinedSurface refined(const TriMesh& surface, double longest, Eigen::Index most) {
  RefinedSurface result;
  std::vector<Vec3> points(std::size_t(surface.points.rows()));
  for (std::size_t v = 0; v < points.size(); ++v) points[v] = surface.points.row(Eigen::Index(v));
  std::vector<CornerNumbers> triangles(std::size_t(surface.triangles.rows()));
  std::vector<std::int32_t> parent(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) triangles[t][std::size_t(k)] = surface.triangles(Eigen::Index(t), k);
    parent[t] = static_cast<std::int32_t>(t);
  }
  // No triangle has more than four parts, so that a pass that starts below a fourth of the limit cannot exceed it.
  for (bool halved = true; halved && 4 * Eigen::Index(triangles.size()) <= most;) {
    Pass pass(points, result.ends, longest);
    std::vector<CornerNumbers> parts;
    std::vector<std::int32_t> parents;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      pass.split(triangles[t], parts);
      parents.resize(parts.size(), parent[t]);
    }
    halved = parts.size() > triangles.size();
    triangles = std::move(parts);
    parent = std::move(parents);
  }
  result.parent = std::move(parent);
  result.mesh.points.resize(Eigen::Index(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) result.mesh.points.row(Eigen::Index(v)) = points[v].transpose();
  result.mesh.triangles.resize(Eigen::Index(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) result.mesh.triangles(Eigen::Index(t), k) = triangles[t][std::size_t(k)];
  }
  return result;
}

}  // namespace supple
