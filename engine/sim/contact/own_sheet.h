// Finds where a sheet, such as cloth, touches itself: vertices before its own triangles, and edges beside its own
// edges, that are not near each other in the mesh. A sheet has a layer on both sides (sheet_layer.h), and touches
// itself where it begins a step with a part in the layer of another one, or with a part that comes through another one
// on its way. Not here: the contacts (own_sheet_points.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/triangles/moving_surface.h"
#include "geometry/triangles/triangle_edges.h"
#include "geometry/triangles/two_edges.h"
#include "sim/model/seams.h"

namespace supple {

class OwnSheet {
 public:
  // moving: the sheet's surface, which the functions below take, too. rest: n x 3 [m]. sewn: pairs of vertices that
  // seams hold together; what is near one of them in the mesh is then near the other one, too.
  OwnSheet(const MovingSurface& moving, const Positions& rest, const std::vector<JoinedVertices>& sewn = {});

  // Tells whether the sheet touches itself on the way that the surface goes in a step. q, x: the places at the start
  // and the end, n x 3 [m], at which the surface must be; carried: the common motion [m].
  bool touches(const MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const;
  // Tells the same of q alone; the surface's start and end must be there.
  bool overlaps(const MovingSurface& moving, const Positions& q) const;
  // Returns a place where an edge passes through a triangle at q; the surface's start and end must be there [m].
  std::optional<Vec3> crossing(const MovingSurface& moving, const Positions& q) const;

  // Lists pairs that may touch, with six times the volumes of the tetrahedra that each pair makes where the step begins
  // [m^3]: their signs tell the sides.
  struct PointPair {
    std::int32_t vertex, triangle;
    double volume;
  };
  struct EdgePair {
    EdgeEnds one, other;
    double volume;
  };
  struct Pairs {
    std::vector<PointPair> points;
    std::vector<EdgePair> edges;

    std::size_t size() const { return points.size() + edges.size(); }
  };
  // Finds the pairs that may come nearer than `margin` [m] in the step.
  void find_pairs(const MovingSurface& moving, const Positions& q, const Positions& x, double margin,
                  const Vec3& carried, Pairs& pairs) const;

  // Describes a point over a triangle.
  struct Over {
    Vec3 weights;  // barycentric, of the place below it; none is negative, and their sum is 1
    Vec3 normal;   // the triangle's unit normal
    double above;  // how far the point is above the triangle's plane, negative behind it [m]
  };
  using Corners = std::array<Vec3, 3>;  // the corners of a triangle [m]
  // Returns how a point is over a triangle; nothing for a point beside the triangle.
  static std::optional<Over> over(const Corners& corners, const Vec3& p);
  // Returns six times the volume of the tetrahedron of a triangle and a point, negative behind the triangle [m^3].
  static double volume(const Corners& corners, const Vec3& p);

  double layer() const { return layer_; }  // [m]

 private:
  // Holds the box in which something moves: three coordinates, and a 0 [m].
  struct PathBox {
    Eigen::Array4d lower, upper;
  };

  template <class Points, class Edges>
  bool any_pair(const MovingSurface& moving, double margin, const Vec3& carried, const Positions& q, const Positions& x,
                const Points& points, const Edges& edges) const;
  void find_boxes(const Vec3& carried, const Positions& q, const Positions& x) const;
  Corners corners_of(std::int32_t triangle, const Positions& x) const;
  // The next three tell whether two things are near each other in the mesh. Two vertices are near if they are the same
  // or joined by an edge, where vertices that a seam joins count as one; two other things are, if a vertex of one is
  // near a vertex of the other.
  bool are_neighbours(std::int32_t a, std::int32_t b) const;
  bool are_beside(std::int32_t vertex, std::int32_t triangle) const;
  bool are_beside(const EdgeEnds& one, const EdgeEnds& other) const;

  bool may_meet(std::int32_t vertex, std::int32_t triangle, const Positions& q, const Positions& x,
                double margin) const;
  bool may_meet(const EdgeEnds& one, const EdgeEnds& other, const Positions& q, const Positions& x,
                double margin) const;
  bool is_apart(std::int32_t vertex, std::int32_t triangle) const;
  bool are_apart(const EdgeEnds& one, const EdgeEnds& other) const;

  Triangles triangles_;
  Positions rest_;
  EdgesByTriangle edges_;
  std::vector<std::int32_t> own_begin_, own_;  // by triangle: vertices that no earlier triangle has
  // By vertex: the other ends of its edges, and those that seams bring there, ascending.
  std::vector<std::int32_t> neighbours_begin_, around_;
  mutable MovingSurface::SheetParts parts_;
  mutable std::vector<PathBox> boxes_;  // by vertex, of the latest search
  double layer_;                        // [m]
};

}  // namespace supple
