#version 330 core
#extension GL_ARB_texture_gather : require
#extension GL_ARB_derivative_control : enable
// How much of the key light and of the sky reaches the ground, at half the picture's resolution. With UNSHADOWED, no
// shadow reaches it.
#include "lighting.glsl"
#ifndef UNSHADOWED
#include "shadow.glsl"
#endif
uniform vec3 occlusion_area;  // x, z of its corner; length of its edge
uniform sampler2D occlusion_map;
uniform float unseen;  // see GroundOcclusion
out vec4 pixel;

// The map is smoothed by a cubic B-spline, so that its texels do not show: four interpolated texels make the sum of
// sixteen (Sigg and Hadwiger 2005, "Fast third-order texture filtering").
float sky_over(vec2 at) {
  vec2 size = vec2(textureSize(occlusion_map, 0));
  vec2 place = at * size - 0.5;
  vec2 f = fract(place), g = 1.0 - f;
  vec2 first = g * g * g / 6.0, last = f * f * f / 6.0;
  vec2 low = first + (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0, high = 1.0 - low;
  vec2 from = (floor(place) + 0.5 - first / low) / size, to = (floor(place) + 1.5 + last / high) / size;
  vec2 lower = vec2(texture(occlusion_map, from).r, texture(occlusion_map, vec2(to.x, from.y)).r);
  vec2 upper = vec2(texture(occlusion_map, vec2(from.x, to.y)).r, texture(occlusion_map, to).r);
  vec2 rows = vec2(dot(lower, vec2(low.x, high.x)), dot(upper, vec2(low.x, high.x)));
  return dot(rows, vec2(low.y, high.y));
}

void main() {
  vec3 ray = ray_corner + 2.0 * gl_FragCoord.x * ray_right + 2.0 * gl_FragCoord.y * ray_up;
  float way = -eye.y / ray.y;  // to the ground; negative where the ray goes to the sky
  if (!(way > 0.0)) discard;
  vec3 world = eye + way * ray;
  vec2 at = (world.xz - occlusion_area.xy) / occlusion_area.z;
  vec2 border = smoothstep(vec2(0.5), vec2(0.42), abs(at - 0.5));
  float open = min(1.0, mix(1.0, sky_over(at), border.x * border.y) + unseen);
#ifdef UNSHADOWED
  float lit = 1.0;
#else
  float lit = light_reaching(world, vec3(0.0, 1.0, 0.0), 0.0, true);
#endif
  pixel = vec4(lit, open, 0.0, 1.0);
}
