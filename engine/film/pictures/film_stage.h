// Makes the stage and the positions that the renderer needs (render/draw_list.h) out of bodies, colliders and their
// states. Nothing is drawn here.
#pragma once

#include <optional>

#include "base/threads.h"
#include "render/draw_list.h"
#include "scene/building/collision_set.h"
#include "scene/building/drawn_body.h"

namespace supple {

struct LookDef;
struct SceneDef;

// Makes the skin of each collider; it is empty where nothing of the collider is drawn.
std::vector<Skin> collider_skins(const std::vector<SceneCollider>& colliders, const std::vector<Body>& bodies);
Bounds bounds_at_rest(const std::vector<Body>& bodies);

// Makes the mesh that is drawn for a collider; it is empty where nothing is drawn.
DrawMesh collider_mesh(const SceneCollider& collider, const Skin& skin);

// Returns the colours of the stage that a look asks for.
StageColors colors_of(const LookDef& look);

// Builds the stage of a film: first the bodies, then the colliders.
Stage make_stage(const SceneDef& scene, const std::vector<Body>& bodies, const std::vector<DrawnBody>& drawn,
                 const std::vector<SceneCollider>& colliders, const std::vector<Skin>& skins, const Font& font);

// Adds the positions of the colliders at a time to a list that already holds those of the bodies.
void add_colliders(const std::vector<SceneCollider>& colliders, const std::vector<Skin>& skins, double time,
                   DrawList& list);

// Rounds skins off where a camera would show their triangles in a picture of this height [pixels], removes the
// triangles that none could show, and calls limit_stretch(). Surfaces of cloth become smooth (drawn_cloth.h); other
// surfaces of meshes are left as they are.
void fit_to_cameras(std::vector<DrawnBody>& drawn, const std::vector<Body>& bodies, const std::vector<Camera>& cameras,
                    int height);

// Rounds the skin of a collider off in the same way, where it follows a shape. Surfaces of files keep their triangles,
// which bodies touch.
void round_for_cameras(Skin& skin, const SceneCollider& collider, const std::vector<Camera>& cameras, int height);

// Returns the largest stretch of an edge of a drawn skin over the largest stretch of the elements (at least 1); nothing
// where no edge is stretched by half, or the skin is the mesh's own boundary. skin: what skin_positions() returns for
// `now`, the positions of the mesh [m].
std::optional<double> skin_excess(const DrawnBody& drawn, const std::vector<float>& skin, const TetMesh& mesh,
                                  const Positions& now);

// Prepares skins for the limit of their stretch (geometry/skins/skin_limit.h). They must already be as they will be
// drawn.
void limit_stretch(std::vector<DrawnBody>& drawn);

// Returns the places of the skin's vertices, n x 3 [m]; after limit_stretch(), edges that are stretched much more than
// the elements are shortened. now: the positions of the mesh [m], in the order of the input file. threads: null where
// the calling thread does it all.
Positions skin_places(const DrawnBody& drawn, const TetMesh& mesh, const Positions& now, Threads* threads = nullptr);
// Returns the same as x y z by skin vertex.
std::vector<float> skin_positions(const DrawnBody& drawn, const TetMesh& mesh, const Positions& now,
                                  Threads* threads = nullptr);

}  // namespace supple
