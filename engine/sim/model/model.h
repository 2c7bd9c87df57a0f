// Describes a body, or several whose steps are made together, as the solver needs it: elements in SIMD blocks, masses,
// handles and the factor of A = M/h^2 + L (Liu et al. 2017, section 3.3). No step changes it; between steps,
// ModelValues may set its numbers again (for replays, and handles that release), and let_flow() the shapes that
// elements keep. Not here: where the body is (State), what drives it (StepInputs). Vertices are renumbered: free ones
// come first, in the factor's order of elimination (so that solves permute nothing), then those that hard handles hold.
// Elements are sorted by material and by their first vertex.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/aligned.h"
#include "base/types.h"
#include "geometry/meshes/mesh.h"
#include "geometry/meshes/vertex_frames.h"
#include "sim/elements/cloth_elements.h"
#include "sim/materials/fibre.h"
#include "sim/materials/flow_rules.h"
#include "sim/materials/material.h"
#include "sim/materials/membrane.h"
#include "sim/model/rest_curvature.h"
#include "sim/model/seams.h"
#include "sim/model/system.h"
#include "sim/model/time_scheme.h"

namespace supple {

enum class ElementKind;  // sim/elements/element.h
struct ElementChunk;     // sim/elements/element_kernels.h
struct ElementRecord;    // sim/elements/element_records.h
struct SystemTerm;

// Describes some vertices that follow a motion given from outside.
struct Handle {
  std::string name;
  // These vertices are numbered as in the mesh. Handles with springs may share some, as long as only one holds at a
  // time.
  std::vector<std::int32_t> vertices;
  double stiffness = 0;  // of the spring from each vertex to its target [N/m]; 0: hard, the rows are eliminated
  bool holds = true;     // false: the springs have been let go and do not pull
};

// Describes a body, so that a model can be built from it.
struct BodyDescription {
  std::string name;
  TetMesh mesh;                     // in its place in the world at rest
  std::vector<Material> materials;  // by region tag of the elements
  std::vector<Fibre> fibres;        // by region tag; empty: none
  std::vector<Spring> springs;      // beside the tetrahedra or, for cloth of springs, instead of them
  std::vector<FlatTriangle> cloth;  // the triangles of cloth that is a continuum, instead of both
  Fabric fabric;                    // of these triangles
  std::vector<SeamPair> seams;      // between places on the border of these triangles, without stiffness
  bool curved = false;              // these triangles bend from the shape of the mesh at rest; else from a flat one
  Triangles surface;                // the surface that contact sees; empty: the boundary of the tetrahedra
  // How far what is drawn reaches beyond this surface, by vertex; contact with other bodies begins there. Empty:
  // nowhere [m]
  std::vector<double> overhang;
  // The places of the drawn skin that touch colliders in the stead of vertices: by vertex, the way at rest from the
  // vertex to its place, n x 3; 0 where the vertex touches colliders itself. Empty: all vertices do [m]
  Positions drawn_offset;
  std::optional<Plasticity> plastic;  // of the tetrahedra; nothing: they keep no dent
  std::optional<Creep> creep;         // of the tetrahedra; nothing: they do not creep
  double density = 1000;              // of the tetrahedra [kg/m^3]
  std::vector<double> point_mass;     // by vertex, on top of the tetrahedra's [kg]; empty: none
  std::vector<Handle> handles;
  double time_step = 1.0 / 30;  // h [s]
  Integrator integrator = Integrator::backward_euler;
  double damping = 0;                                 // beta of stiffness-proportional damping [s]
  StretchInterval fit;                                // equation 11
  Precision precision = Precision::single_precision;  // of the factor, hence of search directions
};

// Counts the elements of a body, without Maxwell arms.
inline std::size_t elements_of(const BodyDescription& body) {
  return std::size_t(body.mesh.tets.rows()) + body.springs.size() + body.cloth.size();
}

// Describes one of the bodies of a model. Elements never join two of them, so that A is block-diagonal by parts.
struct Part {
  std::string name;
  std::int32_t first_free = 0, free = 0;  // its vertices that the solver moves: first_free .. first_free + free - 1
  std::int32_t first_held = 0, held = 0;  // its vertices that hard handles hold
  // Its triangles in Model::surface: first_triangle .. first_triangle + triangles - 1.
  std::int32_t first_triangle = 0, triangles = 0;
  double size = 0;      // diagonal of the rest bounding box [m]
  double mass = 0;      // of the free vertices [kg]
  bool solid = false;   // has tetrahedra, and so an inside
  bool floats = false;  // nothing holds it: A has its translations as known eigenvectors
  double drag = 0;      // beta/h
};

// Holds the places of the drawn skin that touch colliders in the stead of some vertices. Each place moves along with
// its vertex, and its offset from the vertex turns and stretches with the elements there.
struct DrawnPlaces {
  VertexFrames frames;  // those of the vertices
  Positions offset;     // by frame, at rest [m]
};

// As a System, a model is A = w M/h^2 + (e theta^2 + beta/h) L + e theta^2 K, with K the springs of handles.
struct Model : System {
  std::uint64_t structure = 0;  // names the description that the model was built from; new values keep it
  std::string name;             // of the body
  std::vector<Part> parts;      // the bodies whose steps are made together: one, where a body moves by itself
  int vertices = 0;             // n
  int free = 0;                 // vertices that the solver moves: 0 .. free-1
  double time_step = 0;
  double size = 0;                        // of the largest part [m]
  Positions rest;                         // n x 3 [m]
  std::vector<double> mass;               // n [kg]
  double total_mass = 0;                  // mass of the free vertices of all parts [kg]
  std::vector<std::int32_t> input_of;     // vertex of the input file, by vertex of the model
  std::vector<std::int32_t> internal_of;  // vertex of the model, by vertex of the input file
  Triangles surface;                      // the triangles that contact sees, in the order of their lowest vertices
  std::vector<double> overhang;           // of what is drawn beyond this surface, by vertex; empty: none [m]
  DrawnPlaces drawn;                      // what touches colliders in the stead of vertices

  Integrator integrator = Integrator::backward_euler;
  TimeScheme scheme = scheme_of(Integrator::backward_euler);
  bool energy_may_be_negative = false;
  bool has_slack = false;     // some material has none of its stiffness around rest
  double mean_stiffness = 0;  // trace of L over the number of elements [N/m]
  // The sum of k V over the tetrahedra, with kappa where they have fibres, of the larger k times the area over the
  // triangles, and of k r^2 over the springs: the work of the stress k, or of the force k r, on a strain of 1 [J].
  double strain_stiffness = 0;

  std::vector<Material> materials;         // by region
  std::vector<Fibre> fibres;               // by region; empty: none
  std::vector<SystemStiffness> stiffness;  // k by region
  // These two lists have one entry for each body of triangles; the region of a chunk of triangles is the number of its
  // entry.
  std::vector<Fabric> fabrics;
  std::vector<MembraneStiffness> fabric_stiffness;  // what stands for the fabrics in L

  std::optional<Plasticity> plastic;  // of a body alone, as in its description
  std::optional<Creep> creep;         // the same

  // Elements are stored in blocks of block_width; the layouts are those of ElementChunk.
  int elements = 0;
  int blocks = 0;
  std::vector<std::int32_t> element_of_lane;  // by lane: number among the input's elements of this kind; -1: padding
  std::vector<std::uint16_t> corner;
  AlignedVector<double> field;
  AlignedVector<float> single_field;  // the same numbers in single precision
  // Where a body flows, the kernels read these two lists instead, which hold D_m^-1 F_p^-1 in the place of D_m^-1
  // (flow_step.h). They are empty where nothing flows.
  AlignedVector<double> present_field;
  AlignedVector<float> present_single_field;
  std::vector<std::int32_t> chunk_vertex;  // all chunks' lists, one after the other
  struct ChunkRange {
    ElementKind kind;
    int region;
    int first_block, blocks;
    int first_vertex, vertices;  // in chunk_vertex
    std::size_t first_corner, first_field;
    bool is_arm = false;  // of tetrahedra: these are Maxwell arms
  };
  std::vector<ChunkRange> chunks;
  // The largest number of vertices that a chunk has. The positions of a chunk's vertices are copied into a space of its
  // own before it is evaluated. Each space has this size, so that no two threads that work on chunks share one.
  int largest_chunk = 0;

  // The indices of each free vertex in the chunks' lists are slots[slot_begin[v] .. slot_begin[v+1]).
  std::vector<std::int32_t> slot_begin;
  std::vector<std::int32_t> slots;

  struct HandleVertex {
    std::int32_t vertex;
    std::int32_t handle;
    bool holds = true;  // false: the handle has let go, and the vertex may belong to another one
  };
  std::vector<HandleVertex> handled;     // the order of StepInputs::targets
  std::vector<double> handle_stiffness;  // of the spring at each free vertex, 0: none [N/m]; empty when all are hard

  // Holds a symmetric matrix over all vertices, by row.
  struct SparseRows {
    std::vector<std::int32_t> begin;  // n + 1; empty where the matrix is zero
    std::vector<std::int32_t> column;
    std::vector<double> value;
  };
  SparseRows damping;  // (beta/h) L [N/m]
  SparseRows bending;  // Q of bending.h, without its diagonal [N/m]
  // Takes the place of Q in the energy and the forces of cloth that is curved at rest; it is empty where no cloth is. A
  // and the Hessians have Q all the same.
  RestCurvature curvature;
  Seams seams;  // whose second derivative A has as a whole

  bool flows() const { return plastic.has_value() || creep.has_value(); }
  ElementChunk chunk(int index) const;
  // Returns an element's share of L, without that of fibres.
  SystemTerm system_term(const ElementRecord& element) const;
  double overhang_at(std::int32_t vertex) const { return overhang.empty() ? 0 : overhang[std::size_t(vertex)]; }  // [m]
  std::size_t part_number(std::int32_t vertex) const;  // of the part that a vertex belongs to
  const Part& part_of(std::int32_t vertex) const { return parts[part_number(vertex)]; }
};

// Throws InputError: the handle holds a vertex that another one holds.
[[noreturn]] void refuse_second_handle(const BodyDescription& body, const Handle& handle);

// Returns the model of a body. Throws RunError (with the body's name) when A cannot be factored, and InputError when
// the description contradicts itself.
Model build_model(const BodyDescription& description);

}  // namespace supple
