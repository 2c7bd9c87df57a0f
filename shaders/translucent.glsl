// Lets light through: what enters a surface on the side of a lamp leaves it on the other side. The way inside is the
// difference between a point's distance from the lamp and that in the lamp's shadow map, which has where light enters
// (Dachsbacher and Stamminger 2003, "Translucent shadow maps").
uniform sampler2D rim_map;  // as shadow_map, of the rim light
uniform mat4 rim_matrix;
uniform float map_depth;  // from the near end of both maps to the far one, which is also the length of their edges [m]

// Returns the share of light that is left behind the four texels around a place, weighted by how near they are.
float left_behind(sampler2D map, vec2 texel, float depth, float usual_way) {
  vec4 inside = max(depth - textureGather(map, texel / float(map_texels)), 0.0) * map_depth;
  vec4 left = exp(-inside / usual_way);
  vec2 part = fract(texel - 0.5);
  vec2 rows = mix(left.wx, left.zy, part.x);
  return mix(rows.x, rows.y, part.y);
}

// Returns the share of a lamp's light that is left at a point: the mean over a disc of places around it where light may
// have entered, because it is scattered on its way. usual_way: after which a third is left [m]. spread: radius of the disc
// [m]. in_step: see light_reaching.
float light_left(sampler2D map, mat4 matrix, vec3 position, float usual_way, float spread, bool in_step) {
  vec3 at = 0.5 * (matrix * vec4(position, 1.0)).xyz + 0.5;
  vec2 texel = at.xy * float(map_texels);
  float radius = clamp(spread * float(map_texels) / map_depth, 1.5, widest_penumbra);
  vec2 odd = mod(floor(gl_FragCoord.xy), 2.0), inward = 1.0 - 2.0 * odd;
  vec2 way = inward.y * vec2(1.0 - odd.x, odd.x);
  mat2 rotation = mat2(way.x, way.y, -way.y, way.x);  // pixels of a block share their taps, as in light_reaching
  float left = 0.0;
  for (int i = 0; i < 4; ++i) {
    left += 0.25 * left_behind(map, texel + radius * (rotation * around[i]), at.z, usual_way);
  }
  vec3 beside = dFdxFine(vec3(texel, at.z)), over = dFdyFine(vec3(texel, at.z));
  float apart = max(max(length(beside.xy), length(over.xy)), float(map_texels) * max(abs(beside.z), abs(over.z)));
  vec2 mean = block_mean(vec4(left, step(apart, radius), 0.0, 0.0), inward).xy;
  bool covered = all(greaterThan(at, vec3(0.0))) && all(lessThan(at, vec3(1.0)));
  return covered ? (in_step && mean.y > 0.99 ? mean.x : left) : 0.0;
}

// Returns how much of a lamp's light a surface scatters to the side that is turned away from the lamp. In a solid it comes
// out a little past the terminator (Jimenez et al. 2010, "Real-time realistic skin translucency").
float turned_away(vec3 n, vec3 to_lamp, float wrap) { return max(wrap - dot(n, to_lamp), 0.0) / (1.0 + wrap); }

// Returns the light that comes through to a point. The farther it goes in a body, the more of its colour it takes on.
vec3 light_through(Seen seen, vec3 albedo, bool sheet, bool in_step) {
  vec2 own = texelFetch(materials, seen.material + 20).xy;  // the share that passes, and the usual way [m]
  float usual_way = max(own.y, 1e-6), spread = (sheet ? 1.0 : 0.35) * usual_way, wrap = sheet ? 0.0 : 0.3;
  vec3 depth_of_color = sheet ? vec3(1.0) : 1.6 - albedo;
  float key = light_left(shadow_map, light_matrix, seen.world, usual_way, spread, in_step),
        rim = light_left(rim_map, rim_matrix, seen.world, usual_way, spread, in_step);
  vec3 light = key_color * turned_away(seen.normal, key_direction, wrap) * pow(vec3(key), depth_of_color) +
               rim_color * turned_away(seen.normal, normalize(TO_RIM), wrap) * pow(vec3(rim), depth_of_color);
  return own.x * albedo * light;
}
