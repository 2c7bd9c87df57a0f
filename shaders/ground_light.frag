#version 330 core
#extension GL_ARB_texture_gather : require
#extension GL_ARB_derivative_control : enable
// How much of the key light reaches the ground, at half the picture's resolution.
#include "lighting.glsl"
#include "shadow.glsl"
out vec4 pixel;

void main() {
  vec3 ray = ray_corner + 2.0 * gl_FragCoord.x * ray_right + 2.0 * gl_FragCoord.y * ray_up;
  float way = -eye.y / ray.y;  // to the ground; negative where the ray goes to the sky
  if (!(way > 0.0)) discard;
  pixel = vec4(light_reaching(eye + way * ray, vec3(0.0, 1.0, 0.0), 0.0, true));
}
