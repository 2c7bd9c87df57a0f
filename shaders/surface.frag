#version 330 core
#extension GL_ARB_texture_gather : require
#extension GL_ARB_derivative_control : enable
// Shades what the visibility buffer shows. The material is clay with painted layers. A layer's border is the zero of
// its interpolated distance, so it is sharp however coarse the surface is.
#include "film.glsl"
#include "lighting.glsl"
#include "shadow.glsl"
#ifdef ROUGH
#include "roughness.glsl"
#endif
#ifdef COLORED
#include "texture.glsl"
#endif
uniform usampler2D visible;       // by pixel, see Visibility: samples (8 bits) and triangle of two surfaces
uniform samplerBuffer places;     // by vertex: x y z, and the open sky
uniform samplerBuffer normals;    // by vertex, and of cloth how hollow it is there, from -1 to 1
uniform usamplerBuffer triangles; // three vertices; mesh (16 bits), covering layer (4 bits), bordering layers (8 bits)
uniform samplerBuffer paint;      // by vertex and layer: distances, eight for each vertex
uniform samplerBuffer squares;    // by vertex: place in the printed pattern
uniform samplerBuffer materials;  // by mesh, twenty-one texels
#ifdef FIELD
uniform samplerBuffer values;     // by vertex: the field, 0 at the low end of its range and 1 at the high one; negative: none
uniform samplerBuffer colors;     // of the field, from low to high, in the colours of the screen
#endif
#ifdef COLORED
uniform samplerBuffer tints;           // by vertex: the file's colour, linear, and the number of its texture from one, or zero
uniform samplerBuffer texture_places;  // by vertex: place in that texture
#endif
#ifdef WIRES
uniform float wire_width;         // in pixels
#endif
uniform vec2 sample_places[SAMPLES];
out vec4 pixel;

// Barycentric coordinates of where a ray from the eye meets a triangle's plane (Moeller and Trumbore 1997).
vec3 weights_on(vec3 ray, vec3 from_eye, vec3 side_b, vec3 side_c) {
  vec3 p = cross(ray, side_c), q = cross(-from_eye, side_b);
  float determinant = dot(side_b, p);
  float b = dot(-from_eye, p) / determinant, c = dot(ray, q) / determinant;
  return vec3(1.0 - b - c, b, c);
}

// A point of a triangle, as seen through a place in the picture.
struct Seen {
  ivec3 corners;
  int material;            // its mesh's first texel
  int covering;            // the layer that covers all of the triangle, or zero
  uint bordering;          // layers above that one whose borders may run through it, by bit
  float pixel;             // width of a pixel at its place, across the line of sight [m]
  vec3 weights;            // of the corners
  vec3 right, up;          // how the weights change to the next pixel
  vec3 world, normal;
  float open;
#ifdef ROUGH
  vec2 rough;              // share of its parts that have a roughness in the place of a gloss, and that share times it
#endif
#ifdef CLOTH
  float hollow;            // from -1 on the ridges of the side that is seen to 1 in its valleys
  bool back;               // whether the triangle's back is seen
  vec3 slope_b, slope_c;   // how the weights of the second and the third corner grow along the triangle, by metre
#endif
};

Seen look(uint number, vec2 at) {
  Seen seen;
  uvec4 triangle = texelFetch(triangles, int(number & 0xffffffu) - 1);
  seen.corners = ivec3(triangle.xyz);
  seen.material = 21 * int(triangle.w & 0xffffu);
  seen.covering = int(triangle.w >> 16 & 15u);
  seen.bordering = triangle.w >> 20;
  vec4 a = texelFetch(places, seen.corners.x), b = texelFetch(places, seen.corners.y), c = texelFetch(places, seen.corners.z);
  vec3 from_eye = a.xyz - eye, side_b = b.xyz - a.xyz, side_c = c.xyz - a.xyz;
  vec3 ray = ray_corner + at.x * ray_right + at.y * ray_up;
  vec3 weights = weights_on(ray, from_eye, side_b, side_c);
  seen.right = weights_on(ray + ray_right, from_eye, side_b, side_c) - weights;
  seen.up = weights_on(ray + ray_up, from_eye, side_b, side_c) - weights;
  // The place may lie beside the triangle, of which another sample is seen. What is smooth goes on in its plane, but not
  // far, because a triangle that is seen from the side has a long way to there.
  vec3 off = weights - 1.0 / 3.0;
  float far = max(max(abs(off.x), abs(off.y)), abs(off.z));
  weights = far < 1e6 ? 1.0 / 3.0 + off / max(far, 1.0) : vec3(1.0 / 3.0);  // the plane of a sliver may be no plane
  seen.weights = weights;
  seen.pixel = length(ray_right) / length(ray) * length(from_eye);
  seen.world = weights.x * a.xyz + weights.y * b.xyz + weights.z * c.xyz;
  seen.open = dot(weights, vec3(a.w, b.w, c.w));
  seen.normal = normalize(weights.x * texelFetch(normals, seen.corners.x).xyz + weights.y * texelFetch(normals, seen.corners.y).xyz +
                          weights.z * texelFetch(normals, seen.corners.z).xyz);
  vec3 towards = eye - seen.world;
  if (dot(cross(side_b, side_c), towards) < 0.0 && dot(seen.normal, towards) < 0.0) seen.normal = -seen.normal;
#ifdef CLOTH
  vec3 face = cross(side_b, side_c);
  float size = max(dot(face, face), 1e-30);
  seen.back = dot(face, towards) < 0.0;
  vec3 hollows = vec3(texelFetch(normals, seen.corners.x).w, texelFetch(normals, seen.corners.y).w, texelFetch(normals, seen.corners.z).w);
  seen.hollow = dot(weights, hollows) * (seen.back ? -1.0 : 1.0);
  seen.slope_b = cross(side_c, face) / size;
  seen.slope_c = cross(face, side_b) / size;
#endif
  return seen;
}

#ifdef CLOTH
#include "cloth.glsl"
#endif
#ifdef TRANSLUCENT
#include "translucent.glsl"
#endif

#ifdef COLORED
// Returns the colour that the file of the surface gives it.
vec3 color_of_file(Seen seen) {
  vec4 a = texelFetch(tints, seen.corners.x), b = texelFetch(tints, seen.corners.y), c = texelFetch(tints, seen.corners.z);
  vec3 tint = clamp(seen.weights.x * a.rgb + seen.weights.y * b.rgb + seen.weights.z * c.rgb, 0.0, 1.0);
  if (a.w < 0.5) return tint;
  vec2 p = texelFetch(texture_places, seen.corners.x).xy, q = texelFetch(texture_places, seen.corners.y).xy,
       r = texelFetch(texture_places, seen.corners.z).xy;
  vec2 at = seen.weights.x * p + seen.weights.y * q + seen.weights.z * r;
  vec2 right = seen.right.x * p + seen.right.y * q + seen.right.z * r, up = seen.up.x * p + seen.up.y * q + seen.up.z * r;
  return tint * texture_color(int(a.w + 0.5) - 1, at, right, up);
}
#endif

// The way on a surface from one pixel to the next, over a pixel's width, where it is seen at a slant of some 83 degrees.
const float most_slanted = 8.0;

#ifdef ROUGH
// Takes the roughness from a part's colour and gloss: a gloss above 2 is a roughness above that.
vec2 take_roughness(inout vec4 part) {
  vec2 rough = part.a < 1.5 ? vec2(0.0) : vec2(1.0, part.a - 2.0);
  part.a *= 1.0 - rough.x;
  return rough;
}
#endif

vec4 material_of(inout Seen seen) {
  vec4 material = texelFetch(materials, seen.material + seen.covering);
#ifdef ROUGH
  seen.rough = take_roughness(material);
#endif
#ifdef COLORED
  if (texelFetch(materials, seen.material + 17).w > 0.5) material.rgb = color_of_file(seen);
#endif
#ifdef PAINTED
  uint left = seen.bordering;
  do {  // one layer at a time, the lowest first; a block of pixels without a border goes through this once, for nothing
    int layer = left == 0u ? 0 : int(log2(float(left & (~left + 1u))) + 0.5);
    float a = texelFetch(paint, 8 * seen.corners.x + layer).r, b = texelFetch(paint, 8 * seen.corners.y + layer).r;
    vec3 d = vec3(a, b, texelFetch(paint, 8 * seen.corners.z + layer).r);
    // The weights of a triangle that has next to no area are wild. A distance changes by no more than the way on the surface,
    // and within a pixel of the triangle it is nearly one of the corners'.
    float change = min(abs(dot(seen.right, d)) + abs(dot(seen.up, d)), most_slanted * seen.pixel);
    float width = max(texelFetch(materials, seen.material + 9 + layer).r, 1.2 * change);
    float beyond = min(change, 2.0 * seen.pixel);
    float nearest = min(d.x, min(d.y, d.z)) - beyond, furthest = max(d.x, max(d.y, d.z)) + beyond;
    float cover = 1.0 - smoothstep(-0.5 * width, 0.5 * width, clamp(dot(seen.weights, d), nearest, furthest));
    cover = left == 0u ? 0.0 : cover;
    vec4 paint_of_layer = texelFetch(materials, seen.material + 1 + layer);
#ifdef ROUGH
    seen.rough = mix(seen.rough, take_roughness(paint_of_layer), cover);
#endif
    material = mix(material, paint_of_layer, cover);
    left &= left - 1u;
  } while (left != 0u);
#endif
  return material;
}

#ifdef PRINTED
// Computes the factor of the printed pattern on the colour, filtered over the pixel so that it neither flickers nor
// breaks into dots.
float print(Seen seen) {
  float kind = texelFetch(materials, seen.material + 17).x;
  vec2 a = texelFetch(squares, seen.corners.x).xy, b = texelFetch(squares, seen.corners.y).xy, c = texelFetch(squares, seen.corners.z).xy;
  vec2 at = seen.weights.x * a + seen.weights.y * b + seen.weights.z * c;
  vec2 change = abs(seen.right.x * a + seen.right.y * b + seen.right.z * c) + abs(seen.up.x * a + seen.up.y * b + seen.up.z * c);
  vec2 pixel_size = max(change, vec2(1e-6));
  const float half_line = 0.035;
  vec2 away = abs(fract(at - 0.5) - 0.5);
  vec2 line = clamp((half_line + 0.5 * pixel_size - away) / pixel_size, 0.0, 1.0) * min(vec2(1.0), 2.0 * half_line / pixel_size + 0.3);
  float grid = 1.0 - 0.55 * max(line.x, line.y);
  // The chequerboard is the product of two square waves, each integrated over the pixel (box filter).
  vec2 low = 0.5 * (at - 0.5 * pixel_size), high = 0.5 * (at + 0.5 * pixel_size);
  vec2 wave = (abs(fract(high) - 0.5) - abs(fract(low) - 0.5)) / (0.5 * pixel_size);
  float checks = 1.0 - 0.09 * (1.0 + wave.x * wave.y);
  return kind < 0.5 ? 1.0 : kind < 1.5 ? grid : checks;
}
#endif

vec3 light_from(Seen seen, vec4 material, bool first) {
  vec3 n = seen.normal;
  vec3 v = normalize(eye - seen.world);
  vec3 albedo = material.rgb;
#ifdef PRINTED
  albedo *= print(seen);
#endif
  float gloss = material.a;

  // A little wrapping makes plastic look like clay: light bleeds past the terminator, reddened by the material's own
  // colour.
  float facing = dot(n, key_direction);
  float lit = light_reaching(seen.world, n, 1.0, first);
  float wrapped = max((facing + 0.25) / 1.25, 0.0), soft = 0.5;
  bool is_sheet = false;
#ifdef CLOTH
  is_sheet = is_cloth(seen);
  if (is_sheet) soft = 0.15;  // cloth is too thin for this, and its folds would be flat
#endif
  vec3 key = key_color * mix(vec3(max(facing, 0.0)), vec3(wrapped) * (0.55 + 0.45 * albedo), soft) * mix(lit, 1.0, 0.06);
  vec3 fill = fill_color * max(dot(n, normalize(TO_FILL)) * 0.7 + 0.3, 0.0);
  float up = 0.5 + 0.5 * n.y;
  vec3 sky = mix(0.55 * ground_color, sky_color, up);
  float open = seen.open * seen.open;
  vec3 light = albedo * (key * mix(1.0, seen.open, 0.35) + (fill * mix(open, 1.0, 0.3) + sky * open));

  float away = 1.0 - max(dot(n, v), 0.0);
  float edge = away * away * away;
  light += rim_color * edge * max(dot(n, normalize(TO_RIM)) + 0.15, 0.0) * (0.25 + 0.75 * albedo) * seen.open;

  vec3 h = normalize(key_direction + v);
  float power = mix(12.0, 420.0, gloss * gloss);
  float grazing = 1.0 - max(dot(v, h), 0.0);
  float fresnel = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
  light += key_color * fresnel * lit * (power + 8.0) / 25.0 * pow(max(dot(n, h), 0.0), power) * gloss;
  // Wet surfaces also reflect the sky.
  light += sky_color * gloss * gloss * (0.04 + 0.5 * edge * away * away) * open * smoothstep(-0.2, 0.6, reflect(-v, n).y);
#ifdef ROUGH
  if (seen.rough.x > 0.0) light += seen.rough.x * reflections(n, v, seen.rough.y / seen.rough.x, lit, open);
#endif
#ifdef TRANSLUCENT
  light += light_through(seen, albedo, is_sheet, first);
#endif
#ifdef CLOTH
  if (is_sheet) light += sheen(n, v, albedo, lit, open);
#endif
  return light;
}

#ifdef FIELD
bool shows_field(Seen seen) { return texelFetch(materials, seen.material + 17).y > 0.5; }

// Returns the colour of the field's value as the legend has it; grey where there is no value.
vec3 field_color(Seen seen) {
  float a = texelFetch(values, seen.corners.x).r, b = texelFetch(values, seen.corners.y).r, c = texelFetch(values, seen.corners.z).r;
  float low = min(a, min(b, c)), high = max(a, max(b, c));
  float value = clamp(dot(seen.weights, vec3(a, b, c)), low, high);
  float place = clamp(value, 0.0, 1.0) * float(textureSize(colors) - 1);
  int below = min(int(place), textureSize(colors) - 2);
  vec3 color = mix(texelFetch(colors, below).rgb, texelFetch(colors, below + 1).rgb, place - float(below));
  return low < 0.0 ? vec3(0.6) : color;
}
#endif

#ifdef WIRES
// Returns how much of a pixel the nearest edge of the triangle covers. The edges of a triangle that is only a few pixels
// high fade, because they would cover all of it.
float wire(Seen seen) {
  vec3 height = 1.0 / max(sqrt(seen.right * seen.right + seen.up * seen.up), vec3(1e-6));  // in pixels
  vec3 away = abs(seen.weights) * height;
  float nearest = min(away.x, min(away.y, away.z)), least = min(height.x, min(height.y, height.z));
  float cover = clamp(0.5 * wire_width + 0.5 - nearest, 0.0, 1.0);
  return cover * clamp((least - 1.5 * wire_width) / (4.0 * wire_width), 0.0, 1.0);
}
#endif

// Returns the colour of the screen at a point of a surface. A field is shown in the colours of its legend, and the light
// of a grey body darkens them, so that the shape is seen and the hue stays; a little white keeps dark ends from being flat.
// first: whether this is the first surface of the pixel, which all pixels of a block shade at the same time.
vec3 shown(Seen seen, bool first) {
  vec4 material = material_of(seen);
#ifdef FIELD
  bool mapped = shows_field(seen);
  material = mapped ? vec4(vec3(0.55), 0.0) : material;
#ifdef ROUGH
  if (mapped) seen.rough = vec2(0.0);
#endif
#endif
#ifdef CLOTH
  if (is_cloth(seen)) dress(seen, material);
#endif
  vec3 color = film(light_from(seen, material, first)).rgb;
#ifdef FIELD
  float brightness = dot(color, vec3(0.299, 0.587, 0.114));  // luma of BT.601
  float shade = clamp(brightness / 0.78, 0.0, 1.0);
  color = mapped ? field_color(seen) * mix(0.4, 1.0, shade * shade) + 0.09 * shade * shade : color;
#endif
#ifdef WIRES
  color *= 1.0 - 0.65 * texelFetch(materials, seen.material + 17).z * wire(seen);
#endif
  return color;
}

// Returns the mean place of some of a pixel's samples, and their number.
vec3 place_of(uint samples) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < SAMPLES; ++i) sum += float(samples >> i & 1u) * vec3(sample_places[i], 1.0);
  return vec3(sum.xy / max(sum.z, 1.0), sum.z);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec2 surfaces = texelFetch(visible, at, 0).rg;
  if (surfaces.x == 0u) discard;
  vec4 sum = vec4(0.0);
  int looked = 0, looks = surfaces.y == 0u ? 1 : 2;
  do {  // each surface is shaded once
    uint one = looked == 0 || surfaces.y == 0u ? surfaces.x : surfaces.y;
    vec3 place = place_of((looked == 0 ? surfaces.x : surfaces.y) >> 24);
    sum += place.z * vec4(shown(look(one, vec2(at) + place.xy), looked == 0), 1.0);
    ++looked;
  } while (looked < looks);
  pixel = sum / float(SAMPLES);
}
