// The studio's lights are a warm key from the upper left that casts the shadow, a cool fill from the right, a rim light
// from the back, and the sky.
uniform vec3 key_direction;
uniform vec3 eye;
uniform vec3 background;    // linear
uniform vec3 ground_color;  // linear
uniform mat4 light_matrix;
uniform sampler2DShadow shadow_map;
uniform float shadow_offset;    // offset along the normal [m]
uniform float shadow_softness;  // radius of the penumbra, in the map's coordinates

const vec3 key_color = vec3(2.35, 2.20, 1.98);
const vec3 fill_color = vec3(0.46, 0.54, 0.66);
const vec3 rim_color = vec3(1.15, 1.12, 1.05);
const vec3 sky_color = vec3(0.62, 0.66, 0.72);

// The taps lie on a spiral (golden angle); each uses the hardware's bilinear comparison.
const vec2 taps[12] = vec2[12](vec2(0.2041, 0.0000), vec2(-0.2607, 0.2388), vec2(0.0399, -0.4547),
                               vec2(0.3286, 0.4286), vec2(-0.6030, -0.1067), vec2(0.5712, -0.3634),
                               vec2(-0.1910, 0.7108), vec2(-0.3644, -0.7016), vec2(0.7906, 0.2887),
                               vec2(-0.8224, 0.3395), vec2(0.3964, -0.8472), vec2(0.2930, 0.9341));

float shadow(vec3 position, vec3 normal) {
  vec4 p = light_matrix * vec4(position + shadow_offset * normal, 1.0);
  vec3 c = 0.5 * p.xyz + 0.5;
  if (any(lessThan(c, vec3(0.0))) || any(greaterThan(c, vec3(1.0)))) return 1.0;
  // Most points are fully lit or fully in shadow, and four wide taps suffice to tell so.
  float sum = 0.0;
  for (int i = 8; i < 12; ++i) sum += texture(shadow_map, vec3(c.xy + shadow_softness * taps[i], c.z - 0.0012));
  if (sum < 0.01 || sum > 3.99) return 0.25 * sum;
  for (int i = 0; i < 8; ++i) sum += texture(shadow_map, vec3(c.xy + shadow_softness * taps[i], c.z - 0.0012));
  return sum / 12.0;
}
