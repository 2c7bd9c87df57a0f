#include "geometry/triangles/patch_projection.h"

#include "geometry/triangles/numbered_surface.h"

namespace supple {

PatchProjection::PatchProjection(const TriMesh& mesh, const SurfaceFeatures& features)
    : mesh_(mesh), features_(features), triangles_(std::size_t(features.patches)) {
  for (std::size_t t = 0; t < features.patch.size(); ++t) triangles_[at(features.patch[t])].push_back(std::int32_t(t));
  std::vector<std::int32_t> compact(at(mesh.points.rows()), -1), used;
  for (const std::vector<std::int32_t>& own : triangles_) {
    TriMesh part;
    part.triangles = mesh.triangles(own, Eigen::all);
    used.clear();
    for (std::int32_t& v : part.triangles.reshaped()) {
      std::int32_t& now = compact[at(v)];
      if (now < 0) {
        now = std::int32_t(used.size());
        used.push_back(v);
      }
      v = now;
    }
    part.points = mesh.points(used, Eigen::all);
    for (const std::int32_t v : used) compact[at(v)] = -1;
    soups_.emplace_back(std::move(part));
  }
}

PatchProjection::Place PatchProjection::closest(const Vec3& p, std::int32_t patch, const Vec3& facing,
                                                std::int32_t near) const {
  Place guess{-1, p};
  double within = infinity;
  const bool any = facing.isZero();
  if (near >= 0 && features_.patch[at(near)] == patch && (any || area_vector(mesh_, near).dot(facing) > 0)) {
    guess = {near, closest_in_triangle(p, corner(mesh_, near, 0), corner(mesh_, near, 1), corner(mesh_, near, 2))};
    within = (guess.point - p).norm();
  }
  const TriangleSoup& soup = soups_[at(patch)];
  TriangleSoup::Near found = soup.closest(p, within, facing);
  if (found.triangle < 0 && guess.triangle >= 0) return guess;
  if (found.triangle < 0) found = soup.closest(p, infinity, Vec3::Zero());
  return {triangles_[at(patch)][at(found.triangle)], found.point};
}

}  // namespace supple
