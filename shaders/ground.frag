#version 330 core
// The ground is seamless: it receives the shadow and the bodies' occlusion, and fades into the background before its
// end could be seen. Without SHADED it is the bare ground, as it is far from all bodies; with SHADOWED, shadows may fall on it.
// With SHADOWS_ALONE the ground is not seen, and its shadows are black with coverage.
#include "film.glsl"
#include "lighting.glsl"
uniform vec3 stage;  // centre x, z; radius
uniform float key_share, sky_share;  // shares of the key light and of the sky on the open ground
out vec4 pixel;
#ifdef SHADED
uniform sampler2D arriving;  // key light and open sky, at half the resolution
#endif

// Returns the colour of the screen of the ground. lit, open: shares of the key light and of the sky that arrive; away: from
// the middle of the stage, over its radius.
vec3 ground_shown(float lit, float open, float away) {
  // The ground under full light gets its own colour: light is scaled so that key and sky add up to the background's
  // white.
  float key = key_share * mix(0.12, 1.0, lit);
  vec3 light = ground_color * (key * mix(0.55, 1.0, open) + sky_share * open * vec3(0.97, 1.0, 1.04)) * 1.06;
  return film(2.0 * mix(light, background, smoothstep(0.9, 3.2, away))).rgb;
}

void main() {
  vec3 ray = ray_corner + gl_FragCoord.x * ray_right + gl_FragCoord.y * ray_up;
  float way = -eye.y / ray.y;  // to the ground; negative where the ray goes to the sky
  bool sky = !(way > 0.0);
  vec3 world = eye + way * ray;
  float lit = 1.0, open = 1.0;
#ifdef SHADED
  if (sky) discard;
  vec2 size = vec2(textureSize(arriving, 0)), at = 0.5 * gl_FragCoord.xy;
  vec2 light_there = texture(arriving, at / size).rg;
#ifdef SHADOWED
  // Four interpolated texels smooth what shadows differ in from one block of 2 x 2 texels to the next.
  light_there.r = 0.0;
  for (int i = 0; i < 4; ++i) light_there.r += 0.25 * texture(arriving, (at + vec2(i & 1, i >> 1) - 0.5) / size).r;
#endif
  lit = light_there.r;
  open = light_there.g;
#endif
  float away = sky ? 4.0 : length(world.xz - stage.xy) / stage.z;
#ifdef SHADOWS_ALONE
  // Programs lay pictures over each other in the colours of the screen, so that is where the share that is left is taken.
  const vec3 luma = vec3(0.2126, 0.7152, 0.0722);  // of BT.709
  float left = dot(luma, ground_shown(lit, open, away)) / max(dot(luma, ground_shown(1.0, 1.0, away)), 1e-3);
  pixel = vec4(vec3(0.0), clamp(1.0 - left, 0.0, 1.0) + dither());
#else
  pixel = vec4(ground_shown(lit, open, away) + dither(), 1.0);
#endif
}
