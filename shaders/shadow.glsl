// Tells how much of the key light reaches a point. The light is a disc, so a shadow is sharp where it begins at the
// thing that casts it and softens with the distance from there (Fernando 2005, "Percentage-closer soft shadows").
uniform mat4 light_matrix;
uniform sampler2D shadow_map;
uniform float shadow_offset;    // offset of a point along its normal, so that a surface does not shade itself [m]
uniform int map_texels;         // texels along each edge of the map
uniform float widest_penumbra;  // radius of the widest border of a shadow, in texels
uniform float penumbra_slope;   // radius of a border in texels over the difference in depth to what casts it
uniform int most_taps;          // taps that the border of a shadow takes at most
uniform float surely_casters;   // of the four wide taps, casters above which a point is in full shadow

#ifndef GL_ARB_derivative_control
#define dFdxFine dFdx
#define dFdyFine dFdy
#endif

// Places in a disc. Turned by quarters of a circle they are sixteen, with 22.5 degrees between their directions.
const vec2 around[4] = vec2[4](vec2(0.3536, 0.0), vec2(-0.4330, -0.4330), vec2(-0.3026, 0.7304), vec2(0.8642, -0.3580));

float depth_at(vec2 texel) { return texelFetch(shadow_map, clamp(ivec2(floor(texel)), ivec2(0), ivec2(map_texels - 1)), 0).r; }

// Returns the share of the light that passes the four texels around a place, weighted by how near they are.
float passing(vec2 texel, float depth) {
  vec4 there = textureGather(shadow_map, texel / float(map_texels));
  vec2 part = fract(texel - 0.5);
  vec4 free = step(vec4(min(depth, 1.0)), there);
  vec2 rows = mix(free.wx, free.zy, part.x);
  return mix(rows.x, rows.y, part.y);
}

// Returns the mean of a value over a block of 2 x 2 pixels, which are shaded together. inward: from this pixel to the
// middle of its block, 1 or -1 along each axis.
vec4 block_mean(vec4 value, vec2 inward) {
  value += 0.5 * inward.x * dFdxFine(value);
  return value + 0.5 * inward.y * dFdyFine(value);
}

// Returns the share of the key light that reaches a point of a surface.
// in_map: 1 for surfaces that cast shadows themselves, 0 for others. in_step: whether all pixels of a block are here at
// the same time, so that they can share what they find.
float light_reaching(vec3 position, vec3 normal, float in_map, bool in_step) {
  vec4 p = light_matrix * vec4(position + in_map * shadow_offset * normal, 1.0);
  vec3 at = 0.5 * p.xyz + 0.5;
  vec2 texel = at.xy * float(map_texels);
  float depth = at.z - 0.0006 * in_map - 0.0001;
  // Around the point, the surface is taken for its tangent plane, so that it does not cast a shadow on itself.
  vec3 across = mat3(light_matrix) * normal;
  bool turned_away = across.z >= 0.0;
  vec2 slope = -across.xy / min(across.z, -1e-6);
  slope *= min(1.0, 3.0 / max(length(slope), 1e-6)) / float(map_texels);
  // The four pixels of a block turn their taps by quarters of a circle and share them, so that each has four times as
  // many. Turned at random from pixel to pixel, the taps show as grain; all alike and not shared, as sheets.
  vec2 odd = mod(floor(gl_FragCoord.xy), 2.0), inward = 1.0 - 2.0 * odd;
  vec2 way = inward.y * vec2(1.0 - odd.x, odd.x);
  mat2 rotation = mat2(way.x, way.y, -way.y, way.x);
  // They share them where they show the same piece of a surface: no two of them lie far from each other.
  vec3 beside = inward.x * dFdxFine(vec3(texel, at.z)), over = inward.y * dFdyFine(vec3(texel, at.z));
  float pixel_texels = max(length(beside.xy), length(over.xy));
  float apart = max(pixel_texels, float(map_texels) * max(abs(beside.z), abs(over.z)));
  float together = step(apart, 0.25 * widest_penumbra);
  // Most points are fully lit or fully in shadow, and a few wide taps tell so.
  float casters = 0.0, caster_depth = 0.0;
  // Where nothing casts a shadow the map has the depth 1. The ground under a low sun lies deeper still, and must not
  // take that for a caster.
  // What is nearly as deep as the surface itself is a hollow of it rather than a caster.
  float above = depth - in_map * 0.25 * widest_penumbra / float(map_texels);
  for (int i = 0; i < 4; ++i) {
    vec2 off = widest_penumbra * (rotation * around[i]);
    float there = depth_at(texel + off);
    float casts = 1.0 - step(min(above + dot(slope, off), 1.0), there);
    casters += casts;
    caster_depth += casts * there;
  }
  bool inside = all(greaterThan(at, vec3(0.0))) && all(lessThan(at.xy, vec2(1.0)));
  if (!inside) casters = 0.0;
  vec4 found = block_mean(vec4(casters, caster_depth, together, 0.0), inward);
  bool shared = in_step && found.z > 0.99;
  casters = shared ? found.x : casters;
  caster_depth = shared ? found.y : caster_depth;
  // In a narrow fold, what casts the shadow is no deeper than a hollow: only the map's own texel tells so.
  float own = depth_at(texel);
  vec2 to_own = floor(texel) + 0.5 - texel;
  bool in_fold = casters < 0.1 && inside && own < min(depth + dot(slope, to_own), 1.0);
  casters = in_fold ? 1.0 : casters;
  caster_depth = in_fold ? own : caster_depth;
  // The border takes as many taps on a spiral as it needs, one at a time, because a software rasteriser runs through a
  // loop's body once even when no pixel of a block wants it.
  // In a hollow, all of the wide taps may meet the walls while the light still reaches the point itself, or a part of
  // the light where the border is narrow.
  bool reached = own >= min(above, 1.0);
  float radius = clamp(penumbra_slope * (depth - caster_depth / max(casters, 0.1)), 1.0, widest_penumbra);
  bool border = casters > 0.1 && (casters < surely_casters || reached || radius < 0.7 * widest_penumbra) && !turned_away;
  const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
  float lit = 0.0, taken = 0.0;
  vec2 lean = vec2(0.0);  // to where the light passes
  int taps = border ? most_taps : 0;
  do {
    vec2 off = radius * sqrt((taken + 0.5) / float(most_taps)) * way;
    float light = passing(texel + off, depth + dot(slope, off));
    lit += light;
    lean += light * off;
    way = golden * way;
    taken += 1.0;
  } while (int(taken) < taps);
  lit = border ? lit / taken : 1.0 - casters / 4.0;
  // Over the border, light changes by about this much from texel to texel: the slope of the plane that fits what the
  // taps of a disc tell (least squares), so that the mean of a block can be carried back to each of its pixels.
  lean *= border ? 4.0 / (taken * radius * radius) : 0.0;
  vec4 mean = block_mean(vec4(lit, lean, border ? 1.0 : 0.0), inward);
  float carried = clamp(mean.x - 0.5 * dot(mean.yz, beside.xy + over.xy), 0.0, 1.0);
  // A border that is a few pixels wide changes too fast for a plane.
  float wide = smoothstep(3.0, 6.0, radius / max(pixel_texels, 1e-6));
  return shared && mean.w > 0.99 ? mix(lit, carried, wide) : lit;
}
