#include "render/stage_light.h"

namespace supple {

void set_light(const Program& program, const StageLight& light) {
  program.set("key_direction", light.to_key);
  program.set("eye", light.camera.eye);
  program.set("ground_color", light.ground);
  program.set("exposure", light.exposure);
  program.set("key_color", light.rig.key);
  program.set("fill_color", light.rig.fill);
  program.set("rim_color", light.rig.rim);
  program.set("sky_color", light.rig.sky);
  program.set("ray_corner", light.rays.corner);
  program.set("ray_right", light.rays.right);
  program.set("ray_up", light.rays.up);
}

}  // namespace supple
