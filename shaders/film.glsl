// Converts linear light to screen colours.
uniform float exposure;

// Applies a filmic curve with a toe and a shoulder (Narkowicz 2015, "ACES filmic tone mapping curve"), at an exposure
// that brings a white under full light to about 0.8.
vec3 filmic(vec3 light) {
  vec3 x = 0.62 * exposure * light;
  return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

vec3 to_srgb(vec3 c) { return mix(1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308))); }

vec4 film(vec3 light) { return vec4(to_srgb(filmic(light)), 1.0); }
