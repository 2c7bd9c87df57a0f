// Finds where the camera of a film stands at a time.
#pragma once

#include "render/draw_list.h"
#include "scene/definition/scene_def.h"

namespace supple {

// Returns the box that a camera frames [m]: colliders at the start, and the bodies' whole motion where the stage knows
// it; otherwise the bodies at the start, and the ground below those that will fall on it.
Bounds framed_box(const SceneDef& scene, const Stage& stage);

// Returns the object that the camera follows, and how far it has moved. positions: the positions of each mesh, as in a
// DrawList.
std::optional<Followed> followed_at(const SceneDef& scene, const Stage& stage,
                                    const std::vector<std::vector<float>>& positions);

// Returns the camera at a time [s]. positions: the positions of each mesh, as in a DrawList; the camera moves along
// with the mesh that it follows. Without them it stands where it would if that mesh were at rest.
Camera camera_at(const SceneDef& scene, const Stage& stage, double time,
                 const std::vector<std::vector<float>>& positions = {});

// Returns the share of some points, x y z of each [m], that lie within the borders of the camera's picture, whatever
// hides them.
double share_in_picture(const Camera& camera, const Stage& stage, const std::vector<float>& points);

}  // namespace supple
