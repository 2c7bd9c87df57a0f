#version 330 core
// The ground is seamless: it receives the shadow and the bodies' occlusion, and fades into the background before its
// end could be seen.
#include "film.glsl"
#include "lighting.glsl"
in vec3 world;
uniform vec4 stage;           // centre x, z; radius
uniform vec4 occlusion_area;  // x, z of its corner; length of its edge
uniform sampler2D occlusion_map;
out vec4 pixel;
void main() {
  float lit = shadow(world, vec3(0.0, 1.0, 0.0));
  vec2 at = (world.xz - occlusion_area.xy) / occlusion_area.z;
  vec2 border = smoothstep(vec2(0.5), vec2(0.42), abs(at - 0.5));
  float open = mix(1.0, texture(occlusion_map, at).r, border.x * border.y);
  // The ground under full light gets its own colour: light is scaled so that key and sky add up to the background's
  // white.
  float key = 0.62 * mix(0.12, 1.0, lit);
  vec3 light = ground_color * (key * mix(0.55, 1.0, open) + 0.38 * open * vec3(0.97, 1.0, 1.04)) * 1.06;
  float away = length(world.xz - stage.xy) / stage.z;
  pixel = film(2.0 * mix(light, background, smoothstep(0.9, 3.2, away)));
}
