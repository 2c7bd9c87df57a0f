// Defines a body that is ready to run: its mesh and what is known of it. unplaced_body.h makes it from its files, and
// assemble.h places it and gives it its substance. Not here: what is drawn in the place of its mesh (drawn_body.h).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/files/source_file.h"
#include "geometry/meshes/cloth.h"
#include "geometry/meshes/mesh.h"
#include "geometry/meshes/pose.h"
#include "geometry/shapes/shape.h"
#include "scene/definition/body_def.h"
#include "scene/definition/keyed_motion.h"
#include "sim/model/bounces.h"
#include "sim/model/flow.h"
#include "sim/model/model.h"
#include "sim/model/solver_memory.h"

namespace supple {

struct SurfaceColors;  // geometry/skins/surface_colors.h
struct SurfaceParts;   // geometry/files/colored_surface.h

// Holds where a body of an earlier run was at the end of a frame, for a film that goes on from there.
struct EarlierState {
  Positions x, v;  // by vertex of the body's mesh [m], [m/s]
  // Names a handle, and tells whether it held its vertices, and from which places it moves them.
  struct Held {
    std::string handle;
    std::vector<std::int32_t> vertices;  // of the body's mesh
    Positions points;                    // places of these vertices [m]
    Vec3 center;                         // what keys turn about [m]
    bool holds;
  };
  std::vector<Held> handles;
  Flow flow;                           // the shape that the body keeps
  double time = 0;                     // [s]
  std::optional<SolverMemory> memory;  // nothing where the body differs from the run's
  Bounces bounces;                     // none where bodies or colliders differ from the run's
};

// Represents a body that is ready to be simulated and drawn, between what a file says of it (BodyDef, body_def.h) and
// what a step needs (Model, which build_model makes of `description`, and State). MovingBody (world/) moves it.
struct Body {
  // Names a collider that the body starts in, and tells how deep the body is in it [m].
  struct InsideCollider {
    std::string collider;
    double depth;
    bool between;  // whether only places between the body's vertices are inside
  };

  // Describes a seam of a cloth.
  struct Seam {
    std::array<double, 2> length;  // lengths of its sides at rest [m]
    std::size_t pairs;             // number of pairs of places that it joins
    double widest;                 // widest gap between the places of a pair at the start [m]
  };

  BodyDef def;
  BodyDescription description;       // the mesh as placed, and its handles
  std::vector<KeyedMotion> motions;  // by handle
  std::vector<KeyedMotion> earlier;  // the motions before a change that is spread over this frame; else empty
  std::vector<std::string> notes;    // what is to be said of how the body was made
  std::string source;                // the file that it is made from, or a description
  std::vector<SourceFile> files;     // the files from which its mesh and looks were read
  std::vector<std::string> regions;  // names by tag
  std::vector<Seam> seams;           // seams of a cloth, in the order of its definition
  double volume = 0;                 // volume of its tetrahedra at rest [m^3]
  bool holds_gas = false;            // whether its surface was found to be closed, which a pressure needs
  ClothMesh cloth;
  // Places in the texture in which a cloth lies flat at rest, by triangle and corner; empty: each triangle is at rest
  // as it is placed.
  std::vector<std::array<Eigen::Vector2d, 3>> flat;
  TriMesh skin;  // the surface of a body made from one, in the file's frame
  // Colours of `skin`, or of a cloth's triangles; null where the body's own colour is drawn.
  std::shared_ptr<const SurfaceColors> colors;
  std::shared_ptr<const SurfaceColors> file_colors;  // the file's colours, drawn or not; null: it has none
  std::shared_ptr<const SurfaceParts> parts;         // named parts of the same triangles; null: none, or not asked for
  // Texture coordinates by corner of the same triangles; null: the file has none, or nothing asks for them. Not finite
  // where a part of the file has none.
  std::shared_ptr<const std::vector<std::array<Eigen::Vector2d, 3>>> places;
  Shape shape;                                 // the shape of a body made from one, in the file's frame
  Positions unplaced;                          // the rest positions of the mesh in the file's frame
  std::uint64_t seed = 0;                      // seed of its random start
  std::vector<InsideCollider> starts_inside;   // colliders that it starts in; its definition says what is done
  std::optional<EarlierState> from;            // what it goes on from; nothing: it starts as its definition says
  Vec3 start_move = Vec3(0, 0, 0);             // the move out of colliders that the body would start in [m]
  Eigen::Affine3d placement = no_placement();  // map from the file's frame to the world: turns, scales, moves
};

// Returns how many metres one of the file's units is.
inline double scale_of(const Body& body) { return std::cbrt(body.placement.linear().determinant()); }

// Returns the surface of a body's mesh, by its vertices: the triangles of a cloth, or the boundary of a solid.
inline Triangles surface_of(const Body& body) {
  return body.def.cloth ? body.cloth.surface.triangles : boundary_faces(body.description.mesh.tets);
}

// Returns the names of bodies, in their order.
inline std::vector<std::string> names_of(const std::vector<Body>& bodies) {
  std::vector<std::string> names;
  for (const Body& body : bodies) names.push_back(body.def.name);
  return names;
}

}  // namespace supple
