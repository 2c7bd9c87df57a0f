// Finds where a triangle lies deepest in a shape, or comes closest to it: the least signed distance over its points
// (Macklin, Erleben, Mueller, Chentanez, Jeschke, Corse 2020, "Local optimization for robust signed distance field
// collision"). It only asks for closest points, so it serves every shape. Not here: contact.
#pragma once

#include <array>

#include "geometry/shapes/shape_probe.h"

namespace supple {

using TriangleCorners = std::array<Vec3, 3>;

// Describes a place of a triangle, with what a shape answers there.
struct TrianglePlace {
  Vec3 weights;  // of the corners; they add up to 1
  Vec3 point;
  SurfacePoint surface;  // the shape's closest point
};

// Returns the weights of the triangle's point that is closest to p.
Vec3 closest_weights(const TriangleCorners& corners, const Vec3& p);

// Tells whether a triangle has a point in a box that is larger by `grown` on all sides [m]. A value below 0 shrinks it.
bool meets_box(const TriangleCorners& corners, const Bounds& box, double grown);

class TriangleInShape {
 public:
  // half_thickness: Shape::half_thickness [m]; near: a memory of queries (ShapeProbe). Corners, shape and memory must
  // outlive this.
  TriangleInShape(const ShapeProbe& shape, double half_thickness, const TriangleCorners& corners, QueryMemory& near);

  // Returns what the shape answers at the centre.
  const TrianglePlace& center() const { return center_; }

  // Returns a bound below the distances of all points of the triangle from a convex shape: the least distance of a
  // corner from the plane through the surface's point that is closest to the centre. It is no bound for other shapes.
  double bound() const { return bound_; }
  // Returns the distance from the shape at the corner that has the least distance from that plane. For a convex shape
  // it is never below the bound.
  double distance_at_nearest_corner() const;

  // Holds the places of least distance to which the descents from the centre and from each corner lead, without those
  // within a tenth of the longest edge of an earlier one. For a convex shape each of them is a place of the least
  // distance.
  struct Descent {
    std::array<TrianglePlace, 4> places;
    int count = 0;              // of these, 1 to 4
    double at_corners = 1e300;  // the least distance of the corners [m]
  };
  Descent descend() const;

 private:
  TrianglePlace ask(const Vec3& weights) const;
  TrianglePlace descend_from(TrianglePlace place) const;

  const ShapeProbe& shape_;
  const TriangleCorners& corners_;
  QueryMemory& near_;
  double half_thickness_, edge_;
  TrianglePlace center_;
  int nearest_corner_ = 0;
  double bound_ = 0;
};

}  // namespace supple
