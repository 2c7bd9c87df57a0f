// Brings points back to a patch of a surface (feature_lines.h), so that a point of one sheet never ends on another
// sheet that is near, or beyond a crease.
#pragma once

#include <vector>

#include "geometry/triangles/feature_lines.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {

class PatchProjection {
 public:
  // mesh: the surface to which the features belong; it must outlive this object.
  PatchProjection(const TriMesh& mesh, const SurfaceFeatures& features);

  struct Place {
    std::int32_t triangle;  // of the surface
    Vec3 point;
  };
  // Returns the closest point of a patch, among its triangles that face a direction. All of them count where none faces
  // it, and where the direction is zero. near: a triangle that is perhaps close, which makes the search quick; -1:
  // none.
  Place closest(const Vec3& p, std::int32_t patch, const Vec3& facing, std::int32_t near) const;

 private:
  const TriMesh& mesh_;
  const SurfaceFeatures& features_;
  std::vector<std::vector<std::int32_t>> triangles_;  // by patch
  std::vector<TriangleSoup> soups_;                   // by patch
};

}  // namespace supple
