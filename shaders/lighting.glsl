// The studio: a warm key from the upper left that casts the shadow, a cool fill from the right, a rim from behind, and the sky.
uniform vec3 key_direction;
uniform vec3 eye;
uniform vec3 background;    // linear
uniform vec3 ground_color;  // linear
uniform mat4 light_matrix;
uniform sampler2DShadow shadow_map;
uniform float shadow_softness;  // radius of the penumbra, in the map's coordinates

const vec3 key_color = vec3(2.35, 2.20, 1.98);
const vec3 fill_color = vec3(0.46, 0.54, 0.66);
const vec3 rim_color = vec3(1.15, 1.12, 1.05);
const vec3 sky_color = vec3(0.62, 0.66, 0.72);

// Eight taps on a spiral (golden angle), each with the hardware's bilinear comparison.
float shadow(vec3 position, vec3 normal) {
  vec4 p = light_matrix * vec4(position + 0.004 * normal, 1.0);
  vec3 c = 0.5 * p.xyz + 0.5;
  if (any(lessThan(c, vec3(0.0))) || any(greaterThan(c, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    float radius = shadow_softness * sqrt((float(i) + 0.5) / 8.0);
    float angle = 2.39996 * float(i);
    sum += texture(shadow_map, vec3(c.xy + radius * vec2(cos(angle), sin(angle)), c.z - 0.0012));
  }
  return sum / 8.0;
}
