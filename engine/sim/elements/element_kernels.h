// Declares the loops over elements, as a table of functions that is compiled once for each instruction set
// (base/variants.h). All take plain arrays. Not here: the uses of the loops (solver/objective.h, measures/measures.h).
#pragma once

#include <cstdint>

#include "sim/elements/element.h"
#include "sim/materials/material.h"

namespace supple {

// Elements are stored in blocks of this many, whatever the width of the registers: field by field, one element in each
// lane.
constexpr int block_width = 16;

// Lists of a chunk's vertices have this many numbers for each vertex: x, y, z, and one that completes a register.
constexpr int list_stride = 4;

// Describes a run of blocks of one kind and material with its own short list of vertices. It is small enough that its
// positions and forces stay in the first-level cache, and it is the unit of work of a thread.
struct ElementChunk {
  ElementKind kind;
  const Material* material;  // of tetrahedra
  const Fibre* fibre;        // of tetrahedra; null: no fibres
  const Membrane* membrane;  // of triangles
  int blocks;
  int vertices;                 // length of the chunk's list
  const std::int32_t* vertex;   // the list: vertices, by their rows in x
  const std::uint16_t* corner;  // blocks x corners x block_width indices into the list
  const double* field;          // blocks x fields x block_width: what the kind needs to know of an element
  const float* single_field;  // the same numbers in single precision; null: only kernels of double precision are called
};

struct ElementKernels {
  // Writes the energies by element [J] to energy (blocks x block_width); returns the sum of energy - previous (previous
  // may be null: 0). Where force is not null, writes the gradient by list vertex to it (vertices x list_stride) [N]. x:
  // the positions of all vertices, three numbers each [m]. local: scratch of vertices x list_stride.
  double (*elements)(const ElementChunk& chunk, const double* x, const double* previous, double* energy, double* force,
                     double* local);

  // Does the same in single precision: an element's edges are subtracted in double precision, and its forces are added
  // up in double precision; between these, all is single. With u the round-off of single precision, an energy is off by
  // some u times itself, and by the work of the element's stress on strains of about u.
  double (*elements_single)(const ElementChunk& chunk, const double* x, const double* previous, double* energy,
                            double* force, double* local);

  // Writes the second derivatives of each element's energy or, where `project`, positive semi-definite ones near them:
  // for each lane the packed lower triangle over the coordinates of all corners but the first (stiffness_numbers of
  // them); the first corner's rows follow from translations [N/m].
  void (*stiffness)(const ElementChunk& chunk, const double* x, bool project, double* out);

  // Writes a third of the trace of each 3 x 3 block of the projected second derivatives: by lane, the packed lower
  // triangle over all corners but the first (scalar_numbers of them). Along each principal axis, fibre and thread, the
  // stiffness is at least `axial` times that against a stretch along it alone; springs have no such bound. [N/m]
  void (*scalar_stiffness)(const ElementChunk& chunk, const double* x, double axial, double* out);

  // Writes for each lane the largest stretch, and the volume over the rest volume, which is negative where an element
  // is inverted, and 1 for springs and triangles.
  void (*stretches)(const ElementChunk& chunk, const double* x, double* largest, double* volume);

  // Replaces matrices by the rotations of their polar decompositions (polar_rotation.h). They are stored in blocks of
  // block_width: nine entries by rows, one matrix in each lane.
  void (*rotations)(double* matrices, int blocks);
};

constexpr int stiffness_numbers(ElementKind kind) {
  const int inner = 3 * (corners_of(kind) - 1);
  return inner * (inner + 1) / 2;
}
constexpr int scalar_numbers(ElementKind kind) { return corner_pairs(corners_of(kind) - 1); }

// Returns the loops of the widest variant that this machine can run, or those of a given variant, which must be one
// that it can run (base/variants.h).
const ElementKernels& element_kernels();
const ElementKernels& element_kernels(int variant);

}  // namespace supple
