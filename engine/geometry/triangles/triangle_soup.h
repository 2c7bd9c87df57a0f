// Answers questions about triangles that need not bound a solid: which way they wind around a point, what a ray meets
// first, and which of them is near. Surfaces with an inside are in triangle_solid.h. The winding number is that of
// Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for soups and clouds, 2018, with the first two terms
// of its expansion (triangle_tree.h) for parts that are far away.
#pragma once

#include <optional>
#include <vector>

#include "geometry/meshes/mesh.h"
#include "geometry/triangles/triangle_tree.h"

namespace supple {

// Returns the point of a triangle that is closest to p.
Vec3 closest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

// Returns the barycentric weights of a point of a triangle, none of them negative.
Vec3 weights_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

// The object is constant after construction; queries may run on any number of threads and give the same bits on each.
class TriangleSoup {
 public:
  // The triangles must be finite, and there must be at least one. Triangles without area do no harm.
  explicit TriangleSoup(TriMesh mesh);

  // Returns the generalised winding number; it is 1 deep inside a closed surface that faces outward. Near triangles
  // count exactly, far parts by their expansion, with errors of up to about 0.02.
  double winding_number(const Vec3& p) const;

  // Does the same for many places, in groups of 64 that follow one another. It takes less time for each place where
  // those of a group are near each other.
  void winding_numbers(const std::vector<Vec3>& places, std::vector<double>& result) const;

  // Returns the length along a unit direction to the first triangle other than `except` (-1: none is left out),
  // whichever way it faces; nothing when the ray meets none.
  std::optional<double> first_hit(const Vec3& from, const Vec3& direction, Eigen::Index except) const;

  struct Near {
    Eigen::Index triangle = -1;  // -1: there is none
    Vec3 point = Vec3::Zero();
    double squared = 0;  // of the distance [m^2]
  };
  // Returns the closest point within a distance, among triangles whose normal has a positive share along `facing`;
  // among all of them when `facing` is zero.
  Near closest(const Vec3& p, double within, const Vec3& facing) const;

  const TriMesh& mesh() const { return mesh_; }
  const Positions& normals() const { return normals_; }  // unit normals; zero for triangles without area

 private:
  struct Packet;

  Vec3 corner(Eigen::Index triangle, int k) const { return mesh_.points.row(mesh_.triangles(triangle, k)); }

  TriMesh mesh_;
  Positions normals_;
  TriangleTree tree_;
};

}  // namespace supple
