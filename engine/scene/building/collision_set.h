// Defines colliders that are ready for the solver and for the film.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/meshes/pose.h"
#include "geometry/shapes/shape.h"
#include "scene/definition/collider_def.h"
#include "scene/definition/keyed_motion.h"
#include "sim/model/inputs.h"

namespace supple {

struct SceneDef;
struct Skin;  // geometry/skins/skin.h

struct SceneCollider {
  ColliderDef def;  // the shape of a collider that deforms is that at the film's start
  KeyedMotion motion;
  Eigen::Isometry3d rest = no_motion();  // map from its frame to the world before any key

  double scene_fps = 0;

  // Returns the map from the collider's frame to the world at a time [s].
  Eigen::Isometry3d pose(double time) const;
  // Returns the number of the frame of SurfaceMotionDef::motion at a time [s], which need not be whole. To be called
  // only where the collider deforms.
  double frame(double time) const;
  // Returns the shape at a time [s].
  Shape shape_at(double time) const;
};

// Holds how a collider that deforms does so in one step.
struct DeformedStep {
  double from = -1, to = -1;  // frames of its motion
  std::shared_ptr<const TriangleSolid> start, end;
  std::shared_ptr<const SurfaceMove> move;
};

// Holds the colliders of a scene. What bodies do with each other is not here.
struct CollisionSet {
  std::vector<SceneCollider> scene_colliders;
  std::vector<SceneCollider> earlier;  // the colliders before a change that is spread over this frame; else empty
  std::vector<Collider> colliders;     // the scene's colliders in the form that the solver needs
  std::vector<DeformedStep> deformed;  // by collider; empty where none deforms
};
CollisionSet collision_set(const SceneDef& scene);

// Describes a part of the frame in progress: two times [s], and for each of them the share that is done of a change
// which is spread over the frame, 0 to 1.
struct StepSpan {
  double from, to;
  double change_from = 1, change_to = 1;
};

// Sets the shapes of colliders that deform to those at the end of a step from one time to another [s]. They follow from
// these two times alone.
void deform_colliders(CollisionSet& set, double from, double to);

// Computes the motions of all colliders over one step, for which deform_colliders() was called.
void collider_motions(const CollisionSet& set, const StepSpan& span, std::vector<ColliderMotion>& motions);

// Makes the skin of a collider, in its own frame. A half space becomes a square that reaches well beyond `around` (in
// the world). The skin is empty for a collider that is not visible, and for the ground, which every film shows by
// itself.
Skin drawn_collider(const SceneCollider& collider, const Bounds& around);

// Returns the places of that skin's vertices at a time [s], in the collider's frame.
Positions drawn_places(const SceneCollider& collider, const Skin& skin, double time);

// Returns where the vertices of the surface of a collider that deforms are at a time [s], in the world [m].
Positions world_places(const SceneCollider& collider, double time);

// Tells whether a collider is a half space and nothing else.
bool is_half_space(const SceneCollider& collider);

// Tells whether a collider is the half space y < 0, at rest.
bool is_ground(const SceneCollider& collider);

}  // namespace supple
