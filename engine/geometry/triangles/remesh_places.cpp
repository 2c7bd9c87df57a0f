#include "geometry/triangles/remesh_places.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {
namespace {

class PlaceSearch {
 public:
  PlaceSearch(const EditableSurface& edited, const PatchProjection& projection, const SurfaceFeatures& features,
              const WeldedSurface& joined, const TriMesh& surface)
      : edited_(edited), projection_(projection), features_(features), joined_(joined), surface_(surface) {
    around_.resize(at(joined.mesh.points.rows()));
    for (std::int32_t t = 0; t < joined.mesh.triangles.rows(); ++t)
      for (int k = 0; k < 3; ++k) around_[at(joined.mesh.triangles(t, k))].push_back(t);
  }

  // Returns the place of a corner of a triangle, on the triangle's side of each line.
  RemeshedPlace place(const EditableSurface::Triangle& triangle, std::size_t k) const {
    const EditableSurface::Vertex& vertex = edited_.vertex(triangle.corners[k]);
    if (vertex.is_free()) {
      return in_triangle(nearest(vertex.x, triangle, vertex.near), vertex.x);
    }
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t v : triangle.corners) middle += edited_.vertex(v).x / 3;
    // The input's triangle into which a short step toward the middle leads is on the same side.
    const Vec3 inward = vertex.x + 1e-3 * (middle - vertex.x);
    std::int32_t best = -1;
    double squared = infinity;
    for (const std::int32_t t : candidates(vertex)) {
      if (features_.patch[at(t)] != triangle.patch) continue;
      const double own = (closest(t, inward) - inward).squaredNorm();
      if (own < squared) {
        squared = own;
        best = t;
      }
    }
    return in_triangle(best >= 0 ? best : nearest(vertex.x, triangle, -1), vertex.x);
  }

 private:
  Vec3 closest(std::int32_t t, const Vec3& p) const {
    return closest_in_triangle(p, corner(joined_.mesh, t, 0), corner(joined_.mesh, t, 1), corner(joined_.mesh, t, 2));
  }

  std::int32_t nearest(const Vec3& p, const EditableSurface::Triangle& triangle, std::int32_t near) const {
    return projection_.closest(p, triangle.patch, Vec3::Zero(), near).triangle;
  }

  // Lists the input's triangles at the corner, or at the part of the line, where a vertex is.
  std::vector<std::int32_t> candidates(const EditableSurface::Vertex& vertex) const {
    if (vertex.corner >= 0) return around_[at(vertex.corner)];
    const FeatureLine& line = features_.lines[at(vertex.line)];
    const std::size_t segment = segment_of(line, vertex.along);
    std::vector<std::int32_t> both;
    std::ranges::set_intersection(around_[at(line.vertices[segment])], around_[at(line.vertices[segment + 1])],
                                  std::back_inserter(both));
    return both;
  }

  RemeshedPlace in_triangle(std::int32_t t, const Vec3& p) const {
    const std::int32_t source = joined_.triangle_source[at(t)];
    return {source, weights_in_triangle(p, corner(surface_, source, 0), corner(surface_, source, 1),
                                        corner(surface_, source, 2))};
  }

  const EditableSurface& edited_;
  const PatchProjection& projection_;
  const SurfaceFeatures& features_;
  const WeldedSurface& joined_;
  const TriMesh& surface_;
  std::vector<std::vector<std::int32_t>> around_;  // by vertex of the input: its triangles
};

}  // namespace

RemeshedSurface with_places(const EditableSurface& edited, const PatchProjection& projection,
                            const SurfaceFeatures& features, const WeldedSurface& joined, const TriMesh& surface) {
  const PlaceSearch search(edited, projection, features, joined, surface);
  RemeshedSurface result;
  std::vector<std::int32_t> compact(edited.vertices().size(), -1), used;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (const EditableSurface::Triangle& t : edited.triangles()) {
    if (t.is_gone()) continue;
    std::array<std::int32_t, 3>& now = triangles.emplace_back();
    std::array<RemeshedPlace, 3>& places = result.corners.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::int32_t& number = compact[at(t.corners[k])];
      const bool is_new = number < 0;
      // A vertex inside a patch is in one place, whichever triangle asks.
      const bool is_known = !is_new && edited.vertex(t.corners[k]).is_free();
      places[k] = is_known ? result.places[at(number)] : search.place(t, k);
      if (is_new) {
        number = std::int32_t(used.size());
        used.push_back(t.corners[k]);
        result.places.push_back(places[k]);
      }
      now[k] = number;
    }
  }
  result.mesh.points.resize(std::ssize(used), 3);
  for (std::size_t v = 0; v < used.size(); ++v)
    result.mesh.points.row(Eigen::Index(v)) = edited.vertex(used[v]).x.transpose();
  result.mesh.triangles.resize(std::ssize(triangles), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    result.mesh.triangles.row(Eigen::Index(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  return result;
}

}  // namespace supple
