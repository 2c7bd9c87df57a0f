// From definitions to ready-to-run objects: meshes read or made, placed and scaled, handles chosen, models built, skins
// prepared.
#pragma once

#include "geometry/skin.h"
#include "scene/keyed_motion.h"
#include "scene/scene_def.h"

namespace supple {

// What is drawn of a body: a skin carried by its elements, or (vertex_of) the mesh's own boundary.
struct DrawnBody {
  Skin skin;
  Embedding embedding;                  // when the skin is finer than the mesh
  std::vector<std::int32_t> vertex_of;  // when it is the boundary: mesh vertex by skin vertex
  bool two_sided = false;
  Vec3 color;
  std::vector<PaintLayer> layers;  // colours only; their areas live in the skin
};

struct Body {
  BodyDef def;
  BodyDescription description;                              // the mesh as placed, and its handles
  std::vector<KeyedMotion> motions;                         // by handle
  std::vector<std::string> notes;                           // what reading the mesh had to say
  std::string source;                                       // the mesh or shape file, or what it is made of
  Triangles surface;                                        // of cloth
  TriMesh skin;                                             // of a body made from a surface, in the file's frame
  std::uint64_t seed = 0;                                   // of its random start
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();  // from the file's frame to the world: turned, scaled, moved
};

// Throws InputError: unreadable meshes, empty selections, regions that the mesh does not have. All bodies' problems at
// once.
std::vector<Body> assemble(const SceneDef& scene);

// Only for pictures; separate because a run without images does not pay for it.
DrawnBody drawn_body(const SceneDef& scene, const Body& body);

// Where a body starts; handled vertices at rest.
State start_state(const Model& model, const Body& body);

// Targets of all handled vertices, by model.handled.
void handle_targets(const Model& model, const Body& body, double time, Positions& targets);

}  // namespace supple
