// Defines the records of a body's elements before they are packed into SIMD blocks: the model's builder sorts them,
// packs them and adds them up into L.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"
#include "geometry/meshes/mesh.h"
#include "sim/elements/cloth_elements.h"
#include "sim/elements/element.h"

namespace supple {

struct ElementRecord {
  ElementKind kind;
  int region;          // of a tetrahedron: the region of the mesh that it belongs to; of a triangle: its fabric
  std::int32_t input;  // index among the input's elements of this kind
  std::array<std::int32_t, most_corners> corner{};
  std::array<double, most_fields> field{};
  // A tetrahedron that creeps is there twice: its Maxwell arm has the same corners and a share of the volume.
  bool is_arm = false;
};

// Lists the tetrahedra first, then the springs, then the triangles; corners have the mesh's numbering.
std::vector<ElementRecord> element_records(const TetMesh& mesh, const std::vector<Spring>& springs,
                                           const std::vector<FlatTriangle>& triangles);

// Holds the share of an element in L = sum_e G_e^T (weight) G_e: the rows of G_e^T, one for each corner, and their
// weight. The product of two rows and the weight is in N/m.
struct SystemTerm {
  std::array<std::array<double, 3>, most_corners> row{};
  double weight;
};

// Returns the term that an element has with a stiffness of 1: with k = 1 Pa for a tetrahedron, 1 N/m for a spring, and
// 1 N/m in both directions for a triangle.
SystemTerm unit_term(const ElementRecord& element);

// Returns the term of a triangle.
SystemTerm membrane_term(const ElementRecord& element, const MembraneStiffness& stiffness);

// Returns the term of a tetrahedron's fibres.
SystemTerm fibre_term(const ElementRecord& element, const Fibre& fibre);

}  // namespace supple
