// Holds what lights a stage and how it is seen, for the shaders and for the ground.
#pragma once

#include "render/draw_list.h"
#include "render/light_rig.h"
#include "render/program.h"
#include "render/view.h"

namespace supple {

struct StageLight {
  LightRig rig;
  Vec3 to_key;  // unit vector towards the key light
  Camera camera;
  Vec3 background, ground;  // linear
  double exposure;
  Rays rays;
};

// Passes the lights and rays to a program whose shader includes lighting.glsl, or film.glsl too.
void set_light(const Program& program, const StageLight& light);

}  // namespace supple
