// Finds points of a tetrahedral mesh's boundary that are closest to a point, by walking over the boundary from a place
// that is given. What it finds is therefore connected with that place: a foot's point does not find the other foot.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct BoundaryPoint {
  std::int32_t face = -1;   // the row in BoundaryWalk::faces(); -1: none was found
  Vec3 weights;             // the weights of the face's three corners; none is negative, and they sum to 1
  Vec3 point;               // [m]
  double distance = 1e300;  // from the point that was asked for [m]
};

class BoundaryWalk {
 public:
  explicit BoundaryWalk(const TetMesh& mesh);

  const Triangles& faces() const { return faces_; }

  // Returns the point where the walk from the given mesh vertices ends: no face around its face is closer. A vertex
  // inside the solid stands for the boundary vertex to which the fewest edges lead.
  BoundaryPoint from(std::span<const std::int32_t> vertices, const Vec3& point) const;

  // Returns the point closest to `point` on one face.
  BoundaryPoint on(std::int32_t face, const Vec3& point) const;

  Vec3 normal(std::int32_t face) const;       // of unit length, outward
  double mean_edge(std::int32_t face) const;  // [m]

 private:
  void try_faces_around(std::int32_t vertex, const Vec3& point, BoundaryPoint& best) const;
  void find_ways_out(const Tetrahedra& tets);

  Positions rest_;
  Triangles faces_;
  std::vector<std::vector<std::int32_t>> around_;  // faces by mesh vertex
  std::vector<std::int32_t> way_out_;              // by mesh vertex: its boundary vertex; -1: no element leads to one
};

// Returns the barycentric weights of a triangle's closest point (Ericson 2005, "Real-time collision detection", 5.1.5).
Vec3 closest_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& point);

}  // namespace supple
