// Defines colliders that are ready for the solver and for the film.
#pragma once

#include "geometry/meshes/pose.h"
#include "geometry/skins/skin.h"
#include "scene/definition/keyed_motion.h"
#include "sim/model/inputs.h"

namespace supple {

struct SceneCollider {
  ColliderDef def;
  KeyedMotion motion;
  Eigen::Isometry3d rest = no_motion();  // from its frame to the world before any key

  // Returns the map from the collider's frame to the world at a time [s].
  Eigen::Isometry3d pose(double time) const;
};

// Holds all that bodies can collide with: the colliders of the scene, and no other bodies.
struct CollisionSet {
  std::vector<SceneCollider> scene_colliders;
  std::vector<SceneCollider> earlier;  // those before a change that is spread over this frame; else empty
  std::vector<Collider> colliders;     // the scene's colliders in the form that the solver needs
};
CollisionSet collision_set(const SceneDef& scene);

// Describes a part of the frame in progress: two times [s], and how much is done at each of them of a change that is
// spread over the frame, 0 to 1.
struct StepSpan {
  double from, to;
  double change_from = 1, change_to = 1;
};

// Computes the motions of all colliders over one step.
void collider_motions(const CollisionSet& set, const StepSpan& span, std::vector<ColliderMotion>& motions);

// Makes the skin of a collider, in its own frame. A half space becomes a square that reaches well beyond `around` (in
// the world). The skin is empty for the ground that every film has.
Skin drawn_collider(const SceneCollider& collider, const Bounds& around);

// Tells whether a collider is a half space and nothing else.
bool is_half_space(const SceneCollider& collider);

// Tells whether a collider is the half space y < 0, at rest.
bool is_ground(const SceneCollider& collider);

}  // namespace supple
