// Finds where the camera of a film stands at a time.
#pragma once

#include <optional>
#include <vector>

#include "render/draw_list.h"

namespace supple {

struct CameraDef;
struct SceneDef;

// Returns the box that a camera frames where nothing is known of the motion [m]: bodies and colliders at the start, and
// the ground below those bodies that will fall on it.
Bounds framed_box(const SceneDef& scene, const Stage& stage);

// Tells whether the scene sets the distance from the eye to what it sees, so that a picture of another shape shows more
// or less of the scene.
bool is_at_fixed_distance(const CameraDef& camera);

// Tells whether a scene asks for a camera that knows the bodies' whole motion: to frame it, or to keep it in a picture
// that is narrower than the one for which the scene places its camera.
bool wants_motion(const SceneDef& scene);

// Returns the object that the camera follows, and how far it has moved. positions: the positions of each mesh, as in a
// DrawList.
std::optional<Followed> followed_at(const SceneDef& scene, const Stage& stage,
                                    const std::vector<std::vector<float>>& positions);

// Returns the camera at a time [s]. positions: the positions of each mesh, as in a DrawList; the camera moves along
// with the mesh that it follows. Without them it stands where it would if that mesh were at rest.
Camera camera_at(const SceneDef& scene, const Stage& stage, double time,
                 const std::vector<std::vector<float>>& positions = {});

// Returns the distance along the direction of the view at which the camera is focused [m]: that of the body or collider
// that the scene names, by the middle of its vertices, or the scene's own; else that of the target. What a scene names
// may lie beside or behind the eye, where nothing is seen of it; then the target is in focus, too.
double focus_at(const SceneDef& scene, const Camera& camera, const std::vector<std::vector<float>>& positions);

// Returns the share of some points, x y z of each [m], that lie within the borders of the camera's picture, whatever
// hides them.
double share_in_picture(const Camera& camera, const Stage& stage, const std::vector<float>& points);

}  // namespace supple
