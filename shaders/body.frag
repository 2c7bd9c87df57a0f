#version 330 core
// The material is clay with painted layers. A layer's border is the zero of its interpolated distance, so it is sharp
// however coarse the surface is.
#include "film.glsl"
#include "lighting.glsl"
in vec3 world;
in vec3 world_normal;
in float open_sky;
in vec4 layer_low;
in vec4 layer_high;
in vec2 squares;
uniform vec4 colors[9];  // linear colour and gloss; the first is the uncovered surface
uniform vec4 soft[2];
uniform int layers;
uniform int printed;  // 0 nothing, 1 a grid, 2 checks
out vec4 pixel;

vec4 surface() {
  vec4 material = colors[0];
  for (int i = 0; i < layers; ++i) {
    float d = i < 4 ? layer_low[i] : layer_high[i - 4];
    float width = max(soft[i / 4][i % 4], 1.2 * fwidth(d));
    material = mix(material, colors[i + 1], 1.0 - smoothstep(-0.5 * width, 0.5 * width, d));
  }
  return material;
}

// Computes the factor of the printed pattern on the colour, filtered over the pixel so that it neither flickers nor
// breaks into dots.
float print() {
  if (printed == 0) return 1.0;
  vec2 pixel_size = max(fwidth(squares), vec2(1e-6));
  if (printed == 1) {
    const float half_line = 0.035;
    vec2 away = abs(fract(squares - 0.5) - 0.5);
    vec2 line = clamp((half_line + 0.5 * pixel_size - away) / pixel_size, 0.0, 1.0) * min(vec2(1.0), 2.0 * half_line / pixel_size + 0.3);
    return 1.0 - 0.55 * max(line.x, line.y);
  }
  // The chequerboard is the product of two square waves, each integrated over the pixel (box filter).
  vec2 low = 0.5 * (squares - 0.5 * pixel_size), high = 0.5 * (squares + 0.5 * pixel_size);
  vec2 wave = (abs(fract(high) - 0.5) - abs(fract(low) - 0.5)) / (0.5 * pixel_size);
  return 1.0 - 0.09 * (1.0 + wave.x * wave.y);
}

void main() {
  if (world.y < -1e-4) discard;  // below the ground, which is drawn on its own
  vec3 n = normalize(world_normal);
  vec3 v = normalize(eye - world);
  if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
  vec4 material = surface();
  vec3 albedo = material.rgb * print();
  float gloss = material.a;

  // A little wrapping makes plastic look like clay: light bleeds past the terminator, reddened by the material's own
  // colour.
  float facing = dot(n, key_direction);
  float lit = shadow(world, n);
  float wrapped = max((facing + 0.25) / 1.25, 0.0);
  vec3 key = key_color * mix(vec3(max(facing, 0.0)), vec3(wrapped) * (0.55 + 0.45 * albedo), 0.5) * mix(lit, 1.0, 0.06);
  vec3 fill = fill_color * max(dot(n, normalize(vec3(0.95, 0.25, 0.45))) * 0.7 + 0.3, 0.0);
  float up = 0.5 + 0.5 * n.y;
  vec3 sky = mix(0.55 * ground_color, sky_color, up);
  float open = open_sky * open_sky;
  vec3 light = albedo * (key * mix(1.0, open_sky, 0.35) + (fill * mix(open, 1.0, 0.3) + sky * open));

  float edge = pow(1.0 - max(dot(n, v), 0.0), 3.0);
  light += rim_color * edge * max(dot(n, normalize(vec3(0.35, 0.55, -0.8))) + 0.15, 0.0) * (0.25 + 0.75 * albedo) * open_sky;

  vec3 h = normalize(key_direction + v);
  float power = mix(12.0, 420.0, gloss * gloss);
  float fresnel = 0.04 + 0.96 * pow(1.0 - max(dot(v, h), 0.0), 5.0);
  light += key_color * fresnel * lit * (power + 8.0) / 25.0 * pow(max(dot(n, h), 0.0), power) * gloss;
  // Wet surfaces also reflect the sky.
  light += sky_color * gloss * gloss * (0.04 + 0.5 * pow(1.0 - max(dot(n, v), 0.0), 5.0)) * open * smoothstep(-0.2, 0.6, reflect(-v, n).y);
  pixel = film(light);
}
