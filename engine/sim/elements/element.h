// Defines the closed set of element kinds. A new kind needs a header in elements/ (corners, fields, energy with its
// derivative), an entry here, its case in dispatch() of element_kernels.cpp, its records and rows of L in
// element_records.cpp, and an answer wherever the kind is asked for: `grep -rn ElementKind engine` lists these places,
// which are in measures/, model/, coarse/ and solver/ of engine/sim/ and in engine/baselines/.
#pragma once

#include "sim/elements/spring.h"
#include "sim/elements/tetrahedron.h"
#include "sim/elements/triangle.h"

namespace supple {

enum class ElementKind { tetrahedron, spring, triangle };

constexpr int most_corners = 4;
constexpr int most_fields = 10;

constexpr int corners_of(ElementKind kind) {
  switch (kind) {
    case ElementKind::tetrahedron: return Tetrahedron::corners;
    case ElementKind::spring: return SpringElement::corners;
    case ElementKind::triangle: break;
  }
  return Triangle::corners;
}
// Counts the pairs (a, b), a >= b, of an element's corners.
constexpr int corner_pairs(int corners) { return corners * (corners + 1) / 2; }
// The last field of every kind is the element's weight, which is 0 in padding lanes.
constexpr int fields_of(ElementKind kind) {
  switch (kind) {
    case ElementKind::tetrahedron: return Tetrahedron::fields;
    case ElementKind::spring: return SpringElement::fields;
    case ElementKind::triangle: break;
  }
  return Triangle::fields;
}

}  // namespace supple
