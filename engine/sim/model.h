// A body, constant after build: elements in SIMD blocks, masses, handles and the factor of A = M/h^2 + L (Liu et al.
// 2017, section 3.3). Not here: where the body is (State), what drives it (FrameInputs). Vertices are renumbered: free
// ones first, in the factor's order of elimination (so that solves permute nothing), then those that hard handles hold.
// Elements are sorted by material and by their first vertex.
#pragma once

#include <string>

#include "geometry/mesh.h"
#include "sim/cholesky.h"
#include "sim/material.h"

namespace supple {

// Vertices that follow a motion from outside.
struct Handle {
  std::string name;
  std::vector<std::int32_t> vertices;  // of the mesh, in its own numbering; one vertex belongs to one handle
  double spring = 0;  // stiffness of each vertex's spring to its target [N/m]; 0: hard, the rows are eliminated
};

// What a model is built from.
struct BodyDescription {
  std::string name;
  TetMesh mesh;                     // in its place in the world at rest
  std::vector<Material> materials;  // by region tag of the elements
  double density = 1000;            // [kg/m^3]
  std::vector<Handle> handles;
  double time_step = 1.0 / 30;                        // h [s]
  StretchInterval fit;                                // equation 11
  Precision precision = Precision::single_precision;  // of the factor, hence of search directions
};

struct Model {
  std::string name;
  int vertices = 0;  // n
  int free = 0;      // vertices that the solver moves: 0 .. free-1
  double time_step = 0;
  double size = 0;                        // diagonal of the rest bounding box [m]
  Positions rest;                         // n x 3 [m]
  std::vector<double> mass;               // n [kg]
  double total_mass = 0;                  // of the free vertices [kg]
  std::vector<std::int32_t> input_of;     // vertex of the input file by ours
  std::vector<std::int32_t> internal_of;  // ours by vertex of the input file

  std::vector<Material> materials;  // by region
  std::vector<double> stiffness;    // k by region, the floor applied [Pa]
  std::vector<char> floored;        // by region: the fit was below the floor

  // Elements, in blocks of block_width; layouts as in ElementChunk.
  int elements = 0;
  int blocks = 0;
  std::vector<std::int32_t> element_of_lane;  // input's element by lane; -1 for padding
  std::vector<std::uint16_t> corner;
  AlignedVector<double> rest_inverse;
  AlignedVector<double> volume;
  std::vector<std::int32_t> chunk_vertex;  // all chunks' lists, one behind the other
  struct ChunkRange {
    int first_block, blocks, first_vertex, vertices, material;
  };
  std::vector<ChunkRange> chunks;
  int largest_chunk = 0;  // vertices

  // Where each free vertex stands in the chunks' lists: slots[slot_begin[v] .. slot_begin[v+1]).
  std::vector<std::int32_t> slot_begin;
  std::vector<std::int32_t> slots;

  struct HandleVertex {
    std::int32_t vertex;
    std::int32_t handle;
  };
  std::vector<HandleVertex> handled;  // the order of FrameInputs::targets
  struct Coupling {                   // an entry of A between a free vertex and one that a hard handle holds
    std::int32_t free;
    std::int32_t held;
    double value;
  };
  std::vector<Coupling> couplings;  // sorted by free vertex
  std::vector<double> spring;       // by free vertex [N/m]; empty when all handles are hard
  bool free_floating = false;       // nothing holds it: A has the translations as known eigenvectors

  CholeskyFactor factor;  // of A over the free vertices

  ElementChunk chunk(int index) const;
};

// Throws RunError (with the body's name) when A cannot be factored, InputError when the description contradicts itself.
Model build_model(const BodyDescription& description);

}  // namespace supple
