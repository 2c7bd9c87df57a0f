#version 330 core
#extension GL_ARB_texture_gather : require
// How much of the key light and of the sky reaches the ground, at half the picture's resolution.
#include "lighting.glsl"
#include "shadow.glsl"
uniform vec3 occlusion_area;  // x, z of its corner; length of its edge
uniform sampler2D occlusion_map;
uniform float unseen;  // see GroundOcclusion
out vec4 pixel;
void main() {
  vec3 ray = ray_corner + 2.0 * gl_FragCoord.x * ray_right + 2.0 * gl_FragCoord.y * ray_up;
  float way = -eye.y / ray.y;  // to the ground; negative where the ray goes to the sky
  if (!(way > 0.0)) discard;
  vec3 world = eye + way * ray;
  vec2 at = (world.xz - occlusion_area.xy) / occlusion_area.z;
  vec2 border = smoothstep(vec2(0.5), vec2(0.42), abs(at - 0.5));
  float open = min(1.0, mix(1.0, texture(occlusion_map, at).r, border.x * border.y) + unseen);
  pixel = vec4(light_reaching(world, vec3(0.0, 1.0, 0.0), 0.0), open, 0.0, 1.0);
}
