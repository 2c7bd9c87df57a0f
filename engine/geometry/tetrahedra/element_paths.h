// Follows straight lines from a place of a solid's surface through its elements, as it is deformed. A point of the
// surface that lies inside another part of the same solid is found so: the line from the closest place of the surface
// leads to it through elements that are not the point's own. Such a line lies within the body, and so is a way out for
// the point: Chen, Diaz, Yuksel, Shortest path to boundary for self-intersecting meshes, 2023, section 4.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/types.h"

namespace supple {

// The first path that is asked for finds out which elements lie beyond which faces, so that a body that never comes
// near itself does not pay for that. Two threads may not ask for paths at once.
class ElementPaths {
 public:
  // tets: the elements of a solid whose vertices are at `rest`, n x 3 [m]. triangles: its boundary, by vertices of the
  // solid, in any order; those that are no face of an element belong to none.
  ElementPaths(Tetrahedra tets, Triangles triangles, const Positions& rest);

  // Returns the element that contains the end of a straight line which begins at a triangle of the boundary and leads
  // through elements alone. Nothing: the line leaves the elements, or comes to one that has no volume or is inverted.
  // x: n x 3; from: a point of the triangle [m].
  std::optional<std::int32_t> element_at_end(const Positions& x, std::int32_t triangle, const Vec3& from,
                                             const Vec3& to) const;

  // Tells whether two vertices are corners of one element, or the same one.
  bool are_neighbours(std::int32_t a, std::int32_t b) const;
  std::span<const std::int32_t> neighbours(std::int32_t vertex) const;  // with the vertex itself, ascending

  // Tells whether an element at a vertex is collapsed: inverted, or of less than a tenth of its volume at rest. x: n x
  // 3 [m].
  bool is_collapsed_at(const Positions& x, std::int32_t vertex) const;

  // Returns the share of elements that are inverted. x: n x 3 [m].
  double inverted_share(const Positions& x) const;

  // Tells whether a corner of an element is a neighbour of a vertex.
  bool has_neighbour(std::int32_t element, std::int32_t vertex) const;

 private:
  void join_elements() const;
  void list_around(Eigen::Index vertices);
  double volume_of(const Positions& x, std::int32_t element) const;

  Tetrahedra tets_;
  std::vector<double> rest_volume_;  // by element, times six [m^3]
  Triangles triangles_;
  mutable std::vector<std::array<std::int32_t, 4>>
      beyond_;  // by element: the one behind the face opposite a corner; -1: none
  mutable std::vector<std::array<std::int32_t, 2>>
      face_;                                             // by triangle: its element, and the corner opposite; -1: none
  std::vector<std::int32_t> begin_, neighbours_;         // by vertex: its neighbours and itself, ascending
  std::vector<std::int32_t> elements_begin_, elements_;  // by vertex: the elements at it
};

}  // namespace supple
