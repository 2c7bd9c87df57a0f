// Finds where a solid touches itself: points of its surface that come through a triangle of it from outside, or are
// inside another part of it. That a point is behind a triangle does not tell that it is inside, because all of the
// body's far side is behind the triangle. The point is inside where a line from that triangle leads to it through
// elements that are not its own (element_paths.h). Nothing is asked of a point and a triangle near it, which share an
// element or nearly so, nor where elements are turned inside out and have no outside.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/tetrahedra/element_paths.h"
#include "geometry/triangles/moving_surface.h"

namespace supple {

// One body's surface is asked by one thread at a time.
class OwnSurface {
 public:
  static constexpr double same_way = 0.5;  // cosine of normals; a point does not touch a face that faces the same way
  static constexpr double against = -0.1;  // the same for a point deeper behind the face than contact presses it, since
                                           // most points near such a face are on the next side of an edge of the body

  // tets: the body's elements. moving: its boundary; the other methods take the same one, or one of the same triangles
  // and rest positions. rest: n x 3 [m]; size: the size of the body [m].
  OwnSurface(Tetrahedra tets, const MovingSurface& moving, const Positions& rest, double size);

  // Tells whether the body touches itself on the way that the surface goes in a step: whether a point is inside when it
  // begins, or comes through a triangle. Returns false for a body that begins tangled, with more than a hundredth of
  // its elements inverted. q, x: start and end, n x 3 [m]; carried: the common motion [m].
  // moving: its start may be changed.
  bool touches(MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const;
  // Tells whether a point is inside at q alone.
  bool overlaps(MovingSurface& moving, const Positions& q) const;

  // Lists vertices with the triangles that each may touch.
  struct Pairs {
    std::vector<std::int32_t> vertices;   // ascending
    std::vector<std::int32_t> begin;      // where each vertex's triangles begin, and the end
    std::vector<std::int32_t> triangles;  // ascending
    std::vector<double> motion;           // by vertex: how far it moves beside one of its triangles at most, to x [m]

    std::span<const std::int32_t> of(std::size_t index) const {
      return {triangles.data() + begin[index], std::size_t(begin[index + 1] - begin[index])};
    }
  };
  // Finds the pairs that may come nearer than `margin` [m] in the step, and those in which the vertex may begin inside.
  void find_pairs(const MovingSurface& moving, const Positions& q, const Positions& x, double margin,
                  const Vec3& carried, Pairs& pairs) const;

  // Returns the place of the surface by which a vertex has the shortest way out, if it begins the step inside.
  // moving: its start must be at q. triangles: those that the vertex may touch.
  std::optional<MovingSurface::Place> place_around(const MovingSurface& moving, const Positions& q, std::int32_t vertex,
                                                   std::span<const std::int32_t> triangles) const;

  // Tells whether two triangles may be within a distance of each other at rest [m], by balls around them.
  bool are_near_at_rest(std::int32_t a, std::int32_t b, double distance) const;
  double edge() const { return edge_; }  // the mean length of the surface's edges at rest [m]

 private:
  struct Motion;
  bool meets(MovingSurface& moving, const Positions& q, const Positions& x, const Vec3& carried) const;
  // Points that are deeper inside than half an edge are left out, within these limits, over the body's size.
  static constexpr double least_deep = 0.006, most_deep = 0.02;

  double most_cosine(double above) const;  // largest one at which a point so far above a face may touch it
  bool passes(const Positions& q, const Positions& x, std::int32_t vertex, std::int32_t triangle) const;
  bool is_collapsed_around(const Positions& x, std::int32_t vertex, std::int32_t triangle) const;
  Vec3 facing(const MovingSurface& moving, const Positions& x, std::int32_t vertex) const;

  ElementPaths paths_;
  Triangles triangles_;
  mutable MovingSurface::SolidParts parts_;   // with pairs that share an element, to leave them out
  Positions centroids_;                       // of the triangles at rest [m]
  std::vector<double> radius_;                // by triangle, from its centroid at rest [m]
  double edge_ = 0, shallow_ = 0, deep_ = 0;  // [m]
};

}  // namespace supple
