// Represents the solid inside a closed triangle surface and finds closest points and signed distances, for collisions
// and as a shape. Files are read by files/surface_file.h, and closed_surface.h checks that a surface is closed; small
// holes are tolerated. The sign is that of the generalised winding number (Jacobson, Kavan, Sorkine-Hornung, Robust
// inside-outside segmentation using generalized winding numbers, 2013): a point is inside where it exceeds 1/2, so that
// overlapping parts form a union.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "geometry/meshes/mesh.h"
#include "geometry/solids/surface_point.h"

namespace supple {

struct TriangleTree;

// Keeps what queries about places near each other have found, for one caller. It saves work and changes no answer: the
// same place has the same answer, whatever was asked before.
struct QueryMemory {
  struct Answer {
    Vec3 place;
    SurfacePoint surface;
  };
  std::int32_t leaf = -1;  // of the solid's tree, where the last search ended; -1: there was none
  std::array<Answer, 2> answers;
  std::int32_t count = 0;   // of the answers
  std::int32_t oldest = 0;  // of the answers; the next one replaces it
};

// Names the point a + v ab + w ac of a triangle.
struct SurfacePlace {
  std::int32_t triangle;
  double v, w;
};

// Names leaves of a solid's tree. For all places near a point, one of these leaves has the closest triangle.
struct NearLeaves {
  std::array<std::int32_t, 12> leaf;
  int count = 0;
};

// The object is constant after construction; queries may run on any number of threads and give the same bits on each.
class TriangleSolid {
 public:
  // The triangles must have an area, face outward, and have coordinates within +-1e50 (closed_surface ensures this).
  explicit TriangleSolid(TriMesh surface);
  TriangleSolid(TriangleSolid&&) = default;

  // Returns the solid of the same triangles with their vertices elsewhere: quicker than a new one, and with its answers
  // up to round-off. usual_half_thickness() stays what it is here.
  std::shared_ptr<const TriangleSolid> moved(Positions points) const;

  // Returns the closest point of the surface, for any finite point. The distance is exact up to round-off of the
  // surface's coordinates.
  SurfacePoint closest(const Vec3& p) const;

  // Returns the place of the surface that is closest to p.
  SurfacePlace place(const Vec3& p) const;

  // Does the same as closest(p) for a caller that asks about places near each other. The side is found from the
  // surface's normals where that is safe, and otherwise as above.
  SurfacePoint closest(const Vec3& p, QueryMemory& near) const;

  // Does the same, but may return nothing where the surface is not nearer than `most` [m].
  std::optional<SurfacePoint> closest_within(const Vec3& p, double most, QueryMemory& near) const;

  // Returns a bound below the distance of p that follows from earlier answers, less a ten-millionth of the solid's
  // size; minus infinity where nothing follows [m].
  double certain_distance(const Vec3& p, const QueryMemory& near) const;

  // Finds all leaves that come nearer to p than `reach`. Returns false, and finds none, where there are too many.
  bool find_leaves(const Vec3& p, double reach, NearLeaves& found) const;

  // Returns the signed distance, with the bits of closest(p), for a caller who knows that the closest triangle is in
  // one of these leaves.
  double distance_among(const Vec3& p, const NearLeaves& leaves) const;

  // Tells whether every edge is closed, so that the sign changes at the triangles alone.
  bool is_closed() const { return lids_.empty(); }

  // Returns which share of the way from a, which lies outside, to b leads to where it first enters; nothing when it
  // does not.
  std::optional<double> entry(const Vec3& a, const Vec3& b) const;

  // Returns the generalised winding number. Near parts are summed exactly and far ones as dipoles; the result is
  // accurate to about 0.1.
  double winding_number(const Vec3& p) const;

  // Returns half the thickness that all but the thinnest twentieth of the solid has, 0 for a surface with holes [m].
  // The first call measures it.
  double usual_half_thickness() const;

  const Bounds& bounds() const { return bounds_; }
  const TriMesh& surface() const { return surface_; }

 private:
  // The binary tree's nodes are packed so that each has four children, and each leaf up to four triangles, one in each
  // vector lane.
  static constexpr int width = 4;  // as TriangleTree::leaf_size
  // The compiler's vectors: on a machine with shorter registers, it takes several, and the bits are the same.
  using Lanes = double __attribute__((vector_size(width * sizeof(double))));
  struct Lanes3 {
    Lanes x, y, z;
  };
  struct Node {
    Lanes3 lower, upper;                    // boxes of the children; empty where there is no child [m]
    std::array<std::int32_t, width> child;  // index of a node, or the complement of a leaf's index
  };
  struct Dipoles {  // the children as seen from afar
    Lanes3 center;  // mean of the triangles, weighted by area [m]
    Lanes3 area;    // sum of their area vectors [m^2]
    Lanes radius;   // distance from the centre to the furthest corner [m]
  };
  struct Leaf {
    Lanes3 a, ab, ac;                          // a corner, and the edges from it [m]
    Lanes inverse_ab, inverse_ac, inverse_bc;  // 1 / squared length [1/m^2]
    Lanes bc_start;                            // bc . ab [m^2]
    Lanes3 to_v, to_w;                         // their dot products with p - a: v and w of p's foot on the plane [1/m]
    std::array<std::int32_t, width> triangle;  // a short leaf repeats its first triangle
    int count;
  };
  struct Nearest {  // the point a + v ab + w ac of a leaf's lane
    double squared;
    std::int32_t leaf;
    int lane;
    std::int32_t triangle;
    double v, w;
  };
  using Corners = std::array<Vec3, 3>;
  struct Extent;

  TriangleSolid(const TriangleSolid&) = default;
  void measure_size();
  void find_normals();
  void refit();
  Extent extent_of(const Leaf& leaf) const;

  Vec3 corner(Eigen::Index triangle, int k) const { return surface_.points.row(surface_.triangles(triangle, k)); }
  Corners corners(Eigen::Index triangle) const {
    return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  }
  std::int32_t add_node(const TriangleTree& tree, std::int32_t from);
  Leaf leaf_of(std::span<const std::int32_t> triangles) const;
  void build_tree();
  void nearest_in_leaf(const Vec3& p, std::int32_t leaf, Nearest& best) const;
  Nearest nearest(const Vec3& p, std::int32_t likely, double most) const;
  Vec3 point_of(const Nearest& found) const;
  SurfacePoint seen_from(const Vec3& p, const Nearest& found, double sign) const;
  double side_of(const Vec3& p, const Nearest& found) const;
  double side_at(const Vec3& p, const Nearest& found) const {
    return sides_by_normals_ ? side_of(p, found) : inside(p) ? -1 : 1;
  }
  void entry_in_leaf(const Vec3& a, const Vec3& way, std::int32_t leaf, double& first) const;
  bool find_neighbours();
  std::vector<Eigen::Index> one_of_each_component() const;
  bool crosses_itself() const;
  bool pierced_by(std::int32_t from, std::int32_t to) const;
  void prepare_sides();
  void decide_sides();
  void close_holes();
  bool inside(const Vec3& p) const;
  int crossings(const Vec3& p) const;
  static int crossing(const Vec3& p, const Corners& corners, int axis, int direction);

  TriMesh surface_;
  struct Measured {
    std::once_flag once;
    double usual_half_thickness = 0;  // [m]
  };
  std::shared_ptr<Measured> measured_ = std::make_shared<Measured>();  // shared with what moved() returns
  Bounds bounds_;
  double on_surface_ = 0;      // nearer than this, the vector to a query point has no reliable direction [m]
  double certainty_ = 0;       // what certain distances are shorter by, so that round-off can't make them wrong [m]
  std::vector<Corners> lids_;  // triangles that would close the holes; they matter to the sign alone
  std::vector<Node> nodes_;
  std::vector<Dipoles> dipoles_;  // one for each of nodes_
  std::vector<Leaf> leaves_;
  Positions normals_;  // unit normals of the triangles
  // For sides by normals, where that is safe.
  bool sides_by_normals_ = false;
  bool has_neighbours_ = false;  // whether every edge has exactly one neighbour
  Triangles neighbours_;         // of each triangle across its edges from corner 0 to 1, from 1 to 2, and from 2 to 0
  Positions vertex_normals_;     // sums of the triangles' normals, weighted by their angles
};

}  // namespace supple
