// Tells how much of the key light reaches a point. The light is a disc, so a shadow is sharp where it begins at the
// thing that casts it and softens with the distance from there (Fernando 2005, "Percentage-closer soft shadows").
uniform mat4 light_matrix;
uniform sampler2D shadow_map;
uniform float shadow_offset;    // along the normal, so that a surface does not shade itself [m]
uniform int map_texels;         // along each edge
uniform float widest_penumbra;  // radius of the widest border of a shadow, in texels
uniform float penumbra_slope;   // radius of a border in texels over the difference in depth to what casts it
uniform int most_taps;          // that the border of a shadow takes

const vec2 around[8] = vec2[8](vec2(0.2500, 0.0000), vec2(-0.3193, 0.2925), vec2(0.0489, -0.5569),
                               vec2(0.4024, 0.5249), vec2(-0.7386, -0.1307), vec2(0.6996, -0.4450),
                               vec2(-0.2340, 0.8705), vec2(-0.4463, -0.8593));

float depth_at(vec2 texel) { return texelFetch(shadow_map, clamp(ivec2(floor(texel)), ivec2(0), ivec2(map_texels - 1)), 0).r; }

// What share of the light passes the four texels around a place, weighted by how near they are.
float passing(vec2 texel, float depth) {
  vec4 there = textureGather(shadow_map, texel / float(map_texels));
  vec2 part = fract(texel - 0.5);
  vec4 free = step(vec4(min(depth, 1.0)), there);
  vec2 rows = mix(free.wx, free.zy, part.x);
  return mix(rows.x, rows.y, part.y);
}

// in_map: 1 for surfaces that cast shadows themselves, 0 for others.
float light_reaching(vec3 position, vec3 normal, float in_map) {
  vec4 p = light_matrix * vec4(position + in_map * shadow_offset * normal, 1.0);
  vec3 at = 0.5 * p.xyz + 0.5;
  vec2 texel = at.xy * float(map_texels);
  float depth = at.z - 0.0006 * in_map - 0.0001;
  // Around the point, the surface is taken for its tangent plane, so that it does not cast a shadow on itself.
  vec3 across = mat3(light_matrix) * normal;
  bool turned_away = across.z >= 0.0;
  vec2 slope = -across.xy / min(across.z, -1e-6);
  slope *= min(1.0, 3.0 / max(length(slope), 1e-6)) / float(map_texels);
  // A pattern without structure (Jimenez 2014, "interleaved gradient noise") turns the taps from pixel to pixel, so
  // that they do not show as sheets.
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  vec2 way = vec2(cos(turn), sin(turn));
  mat2 rotation = mat2(way.x, way.y, -way.y, way.x);
  // Most points are fully lit or fully in shadow, and eight wide taps tell so.
  float casters = 0.0, caster_depth = 0.0;
  // Where nothing casts a shadow the map has the depth 1. The ground under a low sun lies deeper still, and must not
  // take that for a caster.
  // What is nearly as deep as the surface itself is a hollow of it rather than a caster.
  float above = depth - in_map * 0.25 * widest_penumbra / float(map_texels);
  for (int i = 0; i < 8; ++i) {
    vec2 off = widest_penumbra * (rotation * around[i]);
    float there = depth_at(texel + off);
    float casts = 1.0 - step(min(above + dot(slope, off), 1.0), there);
    casters += casts;
    caster_depth += casts * there;
  }
  bool inside = all(greaterThan(at, vec3(0.0))) && all(lessThan(at.xy, vec2(1.0)));
  if (!inside) casters = 0.0;
  // The border takes as many taps on a spiral as it needs, one at a time, because a software rasteriser runs through a
  // loop's body once even when no pixel of a block wants it.
  // In a hollow, all of the wide taps may meet the walls while the light still reaches the point itself, or a part of
  // the light where the border is narrow.
  bool reached = depth_at(texel) >= min(above, 1.0);
  float radius = clamp(penumbra_slope * (depth - caster_depth / max(casters, 1.0)), 1.0, widest_penumbra);
  bool border = casters > 0.5 && (casters < 7.5 || reached || radius < 0.7 * widest_penumbra) && !turned_away;
  const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
  float lit = 0.0, taken = 0.0;
  int taps = border ? most_taps : 0;
  do {
    vec2 off = radius * sqrt((taken + 0.5) / float(most_taps)) * way;
    lit += passing(texel + off, depth + dot(slope, off));
    way = golden * way;
    taken += 1.0;
  } while (int(taken) < taps);
  return border ? lit / taken : 1.0 - casters / 8.0;
}
