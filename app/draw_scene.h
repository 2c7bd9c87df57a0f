// From bodies and their states to what the renderer draws.
#pragma once

#include "render/draw_list.h"
#include "scene/assemble.h"

namespace supple {

Stage make_stage(const SceneDef& scene, const std::vector<Body>& bodies, const std::vector<DrawnBody>& drawn,
                 const std::string& font);

// The scene's camera, or one that frames all bodies and the motion of their handles.
Camera make_camera(const SceneDef& scene, const Stage& stage);

// x y z by skin vertex.
std::vector<float> skin_positions(const DrawnBody& drawn, const Model& model, const State& state);

}  // namespace supple
