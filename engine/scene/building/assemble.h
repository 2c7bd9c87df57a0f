// Makes ready-to-run objects from definitions: meshes are read or made, placed and scaled, and handles are chosen. What
// is drawn of them is made in drawn_body.h.
#pragma once

#include "base/slow_work.h"
#include "geometry/meshes/cloth.h"
#include "geometry/meshes/pose.h"
#include "geometry/skins/surface_colors.h"
#include "scene/definition/keyed_motion.h"
#include "scene/definition/scene_def.h"
#include "sim/model/state.h"

namespace supple {

// Represents a body that is ready to be simulated and drawn, between what a file says of it (BodyDef, scene_def.h) and
// what a step needs (Model, which build_model makes of `description`, and State). MovingBody (world/) moves it.
struct Body {
  // Names a collider that the body starts in, and tells how deep the body is in it [m].
  struct Overlap {
    std::string collider;
    double depth;
    bool between;  // only places between the body's vertices are inside
  };

  BodyDef def;
  BodyDescription description;       // the mesh as placed, and its handles
  std::vector<KeyedMotion> motions;  // by handle
  std::vector<KeyedMotion> earlier;  // the motions before a change that is spread over this frame; else empty
  std::vector<std::string> notes;    // what reading the mesh had to say
  std::string source;                // the mesh or shape file, or what it is made of
  std::vector<SourceFile> files;     // the files from which its mesh and looks were read
  std::vector<std::string> regions;  // names by tag
  double volume = 0;                 // of its tetrahedra at rest [m^3]
  ClothMesh cloth;
  TriMesh skin;                                 // the surface of a body made from one, in the file's frame
  std::shared_ptr<const SurfaceColors> colors;  // colours of `skin`; null where it has the body's own
  Shape shape;                                  // the shape of a body made from one, in the file's frame
  Positions unplaced;                           // the rest positions of the mesh in the file's frame
  std::uint64_t seed = 0;                       // of its random start
  std::vector<Overlap> overlaps;                // at the start; what the scene does about them is in its definition
  Vec3 start_move = Vec3(0, 0, 0);              // the move out of colliders that the body would start in [m]
  Eigen::Affine3d placement = no_placement();   // from the file's frame to the world: turned, scaled, moved
};

// Makes all bodies of a scene. Throws InputError with the problems of all bodies at once: meshes that cannot be read,
// empty selections, regions that the mesh does not have.
std::vector<Body> assemble(const SceneDef& scene, const SlowWork& work = {});

// Updates the values that may change while a body moves (live_keys.h) to those of the scene's present definition.
// Throws InputError.
void update_body(Body& body, const SceneDef& scene, const BodyDef& def);

// Returns the positions in which a body starts, by vertex of its mesh [m].
Positions first_positions(const Body& body);
// Returns the state in which a body starts: handled vertices are at rest, and handles move them from there.
State start_state(const Model& model, const Body& body);

// Makes a handle grab its vertices at their present positions, from which its keys then move them.
void grab(const Model& model, int handle, const Positions& x, Anchors& anchors);

// Computes the targets of all handled vertices, in the order of model.handled. change: how much is done of a change
// that is spread over the frame, 0 to 1.
void handle_targets(const Model& model, const Body& body, const Anchors& anchors, double time, double change,
                    Positions& targets);
// Does the same for a body whose handles grab nothing and whose definition does not change.
void handle_targets(const Model& model, const Body& body, double time, Positions& targets);

}  // namespace supple
