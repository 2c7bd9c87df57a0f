// A skin is the drawn surface of a body: a contour of its shape that is finer than the elements, with layers of colour,
// carried by the elements in which it lies. Lights and pixels are in render/, the shape's own description in shape.h.
#pragma once

#include <array>

#include "base/texture.h"
#include "geometry/meshes/mesh.h"
#include "geometry/shapes/shape.h"

namespace supple {

constexpr int max_paint_layers = 8;

// Describes where a vertex lies on the flat cloth: along its two axes, and from its open border [m].
using FlatPlace = std::array<float, 3>;
constexpr double no_border = 1e3;  // the distance of what has no border [m]

struct Skin {
  TriMesh rest;                  // in the body's rest frame
  std::vector<float> occlusion;  // share of the sky that the rest shape leaves open at each vertex, 0 to 1
  std::vector<std::array<float, max_paint_layers>> paint;  // signed distance to each colour layer, by vertex [m]
  std::vector<std::array<float, 2>> square;  // place in the printed pattern by vertex, in squares; empty without one
  std::vector<FlatPlace> flat;               // place on the flat cloth by vertex; empty: it is no cloth
  std::vector<SurfaceColor> color;           // colour in the file by vertex; empty where it has none
  // A number for each vertex, if there are colours, or a print with seams: vertices with one number were one vertex
  // before these split it, and have one normal.
  std::vector<std::int32_t> smooth;
  std::vector<std::int32_t> vertex_of;  // by vertex of a collider that deforms: the vertex of its solid; else empty
};

// Contours the shape with cells of the given size [m] (surface_nets.h) and moves the vertices onto the zero set.
TriMesh contour(const Shape& shape, double cell);

// Makes the skin of a shape: its contour, with the distances to the shape's layers and the ambient occlusion at rest.
Skin skin_of(const Shape& shape, double cell);

// Says where the squares lie on a part of a surface that does not face about one way: the part is laid flat
// (flat_charts.h), or each vertex lies where it is along the axes that it faces least, which is enough where squares
// are not drawn.
enum class BentPart { laid, projected };

// Makes a skin without layers from triangles over a mesh's vertices. A vertex on a crease of the surface is split into
// several, so that edges look sharp; vertex_of gives each skin vertex's mesh vertex. square: edge length of the printed
// pattern's squares [m]; 0 prints no pattern. A part that faces about one way is printed along the two axes that it
// faces least; where another one is laid flat, seams split vertices too.
Skin skin_of_surface(const Positions& points, const Triangles& triangles, double square,
                     std::vector<std::int32_t>& vertex_of, BentPart bent = BentPart::laid);

}  // namespace supple
