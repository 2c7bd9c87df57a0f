// Represents the surface of a body that moves in a step: a closed surface, or a sheet, which has no inside. Each vertex
// moves evenly from its place at the start to that at the end. The class finds the place of the surface that is closest
// to a point at either time, and where a point that moves evenly, too, first enters. The boxes of its tree follow the
// vertices; which triangles they hold is fixed by the rest positions. The sign of a distance is that of the
// angle-weighted pseudonormal (Baerentzen, Aanaes, Signed distance computation using the angle weighted pseudonormal,
// 2005), which is right where the surface does not cross itself. Solids that keep their shape are in
// solids/triangle_solid.h.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/types.h"
#include "geometry/triangles/point_passage.h"
#include "geometry/triangles/triangle_tree.h"

namespace supple {

// Queries may run on any number of threads between two calls that set places, and give the same bits on each. Each
// thread needs its own SolidParts or SheetParts where a query takes them.
//
// Where a query takes `carried`, this is a motion in which the surface and what is asked about both take part [m].
// Boxes are compared in the frame that moves by `carried`, so that few triangles need a closer look where all move fast
// together. Queries for entries, crossings and exits have the same answer with each `carried`. The others go by boxes
// alone, and the better `carried` fits, the less often they find something near that is not.
class MovingSurface {
  // The nodes of the binary tree are packed so that each has up to four children: nodes, or the triangles of a leaf.
  static constexpr int width = 4;
  static_assert(width == TriangleTree::leaf_size);
  struct Boxes {
    using Lanes = Eigen::Array<double, width, 1>;
    std::array<Lanes, 3> lower, upper;  // by axis, of a node's children; empty where there is no child [m]
  };

 public:
  // triangles: at least one, m x 3; those without area do no harm, nor do edges with more than two triangles. rest: all
  // vertices of the body, n x 3 [m]; at first, they are the places at the start and at the end.
  MovingSurface(Triangles triangles, const Positions& rest);

  // Sets the places of the vertices at the start and at the end of the step, n x 3 [m]. set_start() takes little time
  // for the places that set_end() has set last.
  void set_start(const Positions& x);
  void set_end(const Positions& x) { set(end_, x); }

  // Describes the place of the surface that is closest to a point.
  struct Place {
    std::int32_t triangle;
    Vec3 weights;     // barycentric, of the triangle's vertices; none is negative, and their sum is 1
    Vec3 point;       // [m]
    double distance;  // negative inside [m]
    Vec3 normal;      // gradient of the distance, of unit length; the pseudonormal where the point is on the surface
  };
  // Tells which triangles a query takes. A vertex of another body, for instance, is not held by triangles that face the
  // way in which the vertex itself faces, such as those on the side of a cube at the edge of a lid.
  using Takes = std::function<bool(std::int32_t triangle)>;
  // Returns the place of the surface that is closest to p at the start or at the end; nothing where the surface is
  // further away than `most` [m]. A point counts as on the surface within a billionth of the largest coordinate. Where
  // all triangles around have no area, the point is outside. takes: null to take all.
  std::optional<Place> closest_at_start(const Vec3& p, double most, const Takes* takes = nullptr) const {
    return closest(start_, p, most, takes);
  }
  std::optional<Place> closest_at_end(const Vec3& p, double most, const Takes* takes = nullptr) const {
    return closest(end_, p, most, takes);
  }

  // Does the same, but looks at the given triangles alone, and at each of them.
  std::optional<Place> closest_at_start(std::span<const std::int32_t> triangles, const Vec3& p, double most,
                                        const Takes& takes) const {
    return closest_among(start_, triangles, p, most, takes);
  }
  std::optional<Place> closest_at_end(std::span<const std::int32_t> triangles, const Vec3& p, double most,
                                      const Takes& takes) const {
    return closest_among(end_, triangles, p, most, takes);
  }

  // Returns how far one triangle is from a point at the end [m].
  double distance_at_end(std::int32_t triangle, const Vec3& p) const;

  // Returns the pseudonormal of a vertex, of unit length; zero where no triangle there has an area.
  Vec3 normal_at_start(std::int32_t vertex) const;
  Vec3 normal_at_end(std::int32_t vertex) const;

  // Describes how a point enters.
  struct Entry {
    std::int32_t triangle;
    Vec3 weights;  // barycentric, of the triangle's vertices; none is negative, and their sum is 1
    double share;  // of the step, 0 to 1
    Vec3 normal;   // of the triangle at that time, of unit length, outward
  };
  // Finds where a point that moves from a to b first passes through a triangle from outside, up to the share `latest`
  // of the step. What counts as passing is said in point_passage.h.
  std::optional<Entry> first_entry(const Vec3& a, const Vec3& b, const Vec3& carried, double latest = 1,
                                   const Takes* takes = nullptr) const;

  // Finds where a point first passes through a triangle from either side. The normal points to the side from which the
  // point comes.
  std::optional<Entry> first_crossing(const Vec3& a, const Vec3& b, const Vec3& carried, double latest = 1) const;

  // Does the same, but looks at the given triangles alone.
  std::optional<Entry> first_crossing(std::span<const std::int32_t> triangles, const Vec3& a, const Vec3& b,
                                      double latest) const;
  std::optional<Entry> first_entry(std::span<const std::int32_t> triangles, const Vec3& a, const Vec3& b,
                                   double latest) const;

  // Finds where a point that moves from a to b last passes through a triangle from inside.
  std::optional<Entry> last_exit(const Vec3& a, const Vec3& b, const Vec3& carried) const;

  // Finds where a straight line from a to b last passes from inside through the surface as it is at the start. The
  // share is that of the line.
  std::optional<Entry> last_exit_at_start(const Vec3& a, const Vec3& b) const;

  // Tells whether a point that moves from a to b may come nearer than `margin` [m] to the surface, by the boxes in
  // which the point and each triangle move.
  bool is_near(const Vec3& a, const Vec3& b, const Vec3& carried, double margin) const;

  // Calls visit(triangle) for each triangle to which an edge may come nearer than `margin` [m], by the boxes in which
  // both move. start, end: the places of the edge's two ends at the start and at the end of the step.
  using VisitTriangle = std::function<void(std::int32_t triangle)>;
  void visit_triangles_near(const std::array<Vec3, 2>& start, const std::array<Vec3, 2>& end, const Vec3& carried,
                            double margin, const VisitTriangle& visit) const;

  // Tells whether a point of the other surface may come nearer than `margin` [m] to this one, by the boxes in which
  // groups of up to four of its triangles move.
  bool may_meet(const MovingSurface& other, double margin, const Vec3& carried) const;

  // Holds what any_own_pair() must know of a solid's parts, which are the nodes of the tree: the pairs of a vertex and
  // a triangle that it leaves out, such as neighbours. The earlier one of two leaves is that with the smaller index.
  struct SolidParts {
    std::vector<std::int32_t> begin;  // by node: where the pairs begin in which it is the earlier leaf; and the end
    std::vector<std::int32_t> later;  // by pair of leaves: that with the larger index, ascending
    // By pair of leaves: bit `width` i + c is set for vertex i of the one and triangle c of the other that are left
    // out. In the first mask, the vertex is of the earlier leaf. Bits of what does not exist are set, too.
    std::vector<std::array<std::uint64_t, 2>> masks;
    // By node: the corners of a leaf's triangles, as places in own_vertices_.
    std::vector<std::array<std::int32_t, 3 * width>> corners;

    // The rest is known for one query, in the frame that moves by `carried`, and is room that is kept for the next one.
    // Holds where a vertex is at q, and the box in which it moves; the fourth number is none.
    struct Path {
      Eigen::Array4d start, lower, upper;
    };
    std::vector<Path> paths;  // by place in own_vertices_
    struct Family {
      Boxes swept, normals;  // around the ways of what a node's children hold, and around its unit normals at q
    };
    std::vector<Family> families;  // by node
  };
  // Puts the triangles that are left out beside a vertex into an empty list, in any order; one may come twice.
  using TrianglesOf = std::function<void(std::int32_t vertex, std::vector<std::int32_t>& triangles)>;
  SolidParts solid_parts(const TrianglesOf& triangles_of) const;

  // Looks for vertices of the surface and triangles of its own that may come nearer than `margin` [m] to each other
  // while the surface moves from q to x, n x 3 [m]; the places that were set do not matter. Calls visit(vertex,
  // triangle) for each pair whose boxes do, until one call returns true; tells whether one did. Left out are, beside
  // the pairs that are listed, those of a vertex and a triangle of one leaf of the tree, and pairs from two parts of
  // the surface between whose normals at the start all cosines are above `same_way`. Otherwise, a smooth surface would
  // meet itself at each vertex.
  using VisitPair = std::function<bool(std::int32_t vertex, std::int32_t triangle)>;
  bool any_own_pair(SolidParts& parts, const Positions& q, const Positions& x, double margin, const Vec3& carried,
                    double same_way, const VisitPair& visit) const;

  // Holds what any_own_triangles() must know of a sheet's parts, which are the nodes of the tree.
  struct SheetParts {
    std::vector<char> is_connected;               // by node: whether its triangles hang together by vertices
    std::vector<std::vector<std::int32_t>> rims;  // by node: vertices that other triangles have too, ascending
    // Keeps boxes around the normals of what each node's children hold, for one pose, from query to query.
    struct Normals {
      std::uint64_t pose = 0;
      std::vector<Boxes> normals;
    };
    Normals start, end;
  };
  SheetParts sheet_parts() const;

  // Looks for triangles of a sheet that may come nearer than `margin` [m] to each other. Calls visit(one, other) for
  // pairs of triangles whose boxes do, each pair once, until one call returns true; tells whether one did. Left out are
  // triangles of a part that hangs together and is nearly flat: there is a direction to which all of its normals have
  // an angle well below a right one, at the start and at the end (Volino and Magnenat-Thalmann 1994, "Efficient
  // self-collision detection on smoothly discretized surface animations using geometrical shape regularity").
  using VisitTriangles = std::function<bool(std::int32_t one, std::int32_t other)>;
  bool any_own_triangles(SheetParts& parts, double margin, const Vec3& carried, const VisitTriangles& visit) const;

  const Triangles& triangles() const { return triangles_; }
  std::span<const std::int32_t> around(std::int32_t vertex) const;  // the triangles at a vertex
  const Positions& start() const { return start_.x; }
  const Bounds& bounds_at_start() const { return start_.bounds; }
  const Bounds& bounds_at_end() const { return end_.bounds; }

 private:
  struct Node {
    // Each is the index of a node, larger than that of this one, or the complement of a triangle.
    std::array<std::int32_t, width> child;
    int count = 0;
    std::int32_t first_vertex = 0, vertices = 0;  // a range of own_vertices_

    bool is_leaf() const { return child[0] < 0; }
  };
  // Holds the surface at one time.
  struct Pose {
    Positions x;               // n x 3 [m]
    std::uint64_t number = 0;  // number of the pose among all that were set
    std::vector<Boxes> boxes;  // one for each node
    Bounds bounds;
    double on_surface = 0;  // nearer than this, the vector to a point has no reliable direction [m]
  };

  struct OwnSearch;    // own_pairs.cpp
  struct SheetSearch;  // own_triangles.cpp

  using Corners = std::array<std::array<Boxes::Lanes, 3>, 3>;  // of a leaf's triangles, by corner and axis
  Corners corners(const Positions& x, const Node& leaf) const;
  static std::array<Boxes::Lanes, 3> unit_normals(const Corners& corner);
  void find_normals(const Pose& pose, SheetParts::Normals& of) const;
  std::int32_t add_node(const TriangleTree& tree, std::int32_t from);
  void list_triangles_around();
  void list_own_vertices();
  void set(Pose& pose, const Positions& x);

  Vec3 corner(const Pose& pose, std::int32_t t, int k) const { return pose.x.row(triangles_(t, k)); }
  Vec3 unit_normal(const Pose& pose, std::int32_t t) const;
  Vec3 edge_normal(const Pose& pose, std::int32_t a, std::int32_t b) const;
  Vec3 vertex_normal(const Pose& pose, std::int32_t vertex) const;
  Vec3 pseudonormal(const Pose& pose, std::int32_t t, const Vec3& weights) const;
  std::optional<Place> closest(const Pose& pose, const Vec3& p, double most, const Takes* takes) const;
  std::optional<Place> closest_among(const Pose& pose, std::span<const std::int32_t> triangles, const Vec3& p,
                                     double most, const Takes& takes) const;
  Place seen_from(const Vec3& p, const Pose& pose, std::int32_t t, const Vec3& weights, const Vec3& offset) const;

  std::optional<Entry> first_passing(const Vec3& a, const Vec3& b, const Vec3& carried, double latest,
                                     bool is_backwards, const Takes* takes) const;
  SeenTriangle seen_triangle(std::int32_t t, const Vec3& a, const Vec3& b) const;
  void take_first_crossing(std::int32_t t, const Vec3& a, const Vec3& b, double roundoff, double latest,
                           std::optional<Entry>& first) const;
  static void take_if_earlier(std::int32_t t, const SeenTriangle& seen, double roundoff, double latest,
                              std::optional<Entry>& first);
  Bounds swept_box(std::int32_t node, const Vec3& carried) const;
  template <class Visit>
  bool any_triangle(const Bounds& box, const Vec3& carried, const Visit& visit) const;
  template <class Visit>
  bool any_leaf_of(const MovingSurface& other, double margin, const Vec3& carried, const Visit& visit) const;

  Triangles triangles_;
  std::vector<Node> nodes_;                 // the root first
  std::vector<std::int32_t> around_start_;  // where each vertex's triangles begin in around_; n + 1
  std::vector<std::int32_t> around_;
  std::vector<std::int32_t> own_vertices_;  // vertices by leaf; each belongs to one leaf that has a triangle at it
  std::uint64_t poses_ = 0;                 // how many poses were set
  Pose start_, end_;
};

}  // namespace supple
