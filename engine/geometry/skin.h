// The drawn surface of a body: a finer contour of its shape than the elements have, with colour layers, carried by the
// elements it lies in. Not here: lights and pixels (render/), the shape's own description (shape.h).
#pragma once

#include <array>

#include "base/names.h"
#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace supple {

constexpr int max_paint_layers = 8;

// What is printed on a body, in squares of one size, so that one sees how it is strained.
enum class Pattern { none, grid, checks };
template <>
struct Names<Pattern> {
  static constexpr std::array table = {Name{Pattern::none, "none"}, Name{Pattern::grid, "grid"},
                                       Name{Pattern::checks, "checks"}};
};

struct Skin {
  TriMesh rest;                  // in the body's rest frame
  std::vector<float> occlusion;  // by vertex: share of the sky that the rest shape leaves open, 0 to 1
  std::vector<std::array<float, max_paint_layers>> paint;  // by vertex: signed distance to each colour layer [m]
  std::vector<std::array<float, 2>> square;  // by vertex: place in the printed pattern, in squares; empty: none
};

// Contour with cells of the given size [m] (surface nets), its vertices moved onto the zero set.
TriMesh contour(const Shape& shape, double cell);

// The contour with its layers' distances and the ambient occlusion of the rest shape.
Skin skin_of(const Shape& shape, double cell);

// Triangles of a mesh's vertices as a skin without layers. Vertices where the surface has a crease become several, so
// that edges look sharp; vertex_of gives each skin vertex's mesh vertex. square: edge of a printed pattern's squares
// [m], laid along the two axes that the surface faces least; 0: none.
Skin skin_of_surface(const Positions& points, const Triangles& triangles, double square,
                     std::vector<std::int32_t>& vertex_of);

// Points as fixed combinations of mesh vertices.
struct Embedding {
  Tetrahedra corners;  // mesh vertices of each point, n x 4
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>
      weights;  // barycentric; sum to 1, negative outside the element
};

// Each point in the element that holds it, or the one that it lies least outside of.
Embedding embed(const Positions& points, const TetMesh& mesh);

// result = the embedded points at the mesh's current positions.
void apply(const Embedding& embedding, const Positions& mesh_positions, Positions& result);

}  // namespace supple
