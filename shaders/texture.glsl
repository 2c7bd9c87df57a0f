// Reads textures from one buffer (engine/render/texture_buffer.h) with a filter of its own: linear within a level and
// between two levels, with up to four places along the longer axis of a pixel's footprint (after Heckbert 1989,
// "Fundamentals of texture mapping and image warping", whose ellipse they stand for).
uniform samplerBuffer texels;   // linear colours, by level, rows from the bottom
uniform usamplerBuffer levels;  // by texture: first level, number of levels, and how it goes on beyond its edges along u
                                // and v; by level: first texel, width and height

int beyond_edges(int i, int size, uint rule) {
  if (rule == 1u) return clamp(i, 0, size - 1);
  int period = rule == 2u ? 2 * size : size;
  int inside = i % period;
  inside += inside < 0 ? period : 0;
  return inside < size ? inside : period - 1 - inside;
}

vec3 level_color(int level, uvec2 rule, vec2 at) {
  uvec4 here = texelFetch(levels, level);
  ivec2 size = ivec2(here.yz);
  vec2 place = at * vec2(size) - 0.5;
  vec2 low = floor(place), part = place - low;
  int left = beyond_edges(int(low.x), size.x, rule.x), right = beyond_edges(int(low.x) + 1, size.x, rule.x);
  int down = int(here.x) + size.x * beyond_edges(int(low.y), size.y, rule.y);
  int up = int(here.x) + size.x * beyond_edges(int(low.y) + 1, size.y, rule.y);
  vec3 below = mix(texelFetch(texels, down + left).rgb, texelFetch(texels, down + right).rgb, part.x);
  vec3 above = mix(texelFetch(texels, up + left).rgb, texelFetch(texels, up + right).rgb, part.x);
  return mix(below, above, part.y);
}

// right, up: how the place in the texture changes to the next pixel.
vec3 texture_color(int number, vec2 at, vec2 right, vec2 up) {
  uvec4 head = texelFetch(levels, number);
  vec2 size = vec2(texelFetch(levels, int(head.x)).yz);
  vec2 across = right * size, along = up * size;
  float longer = max(max(length(across), length(along)), 1e-6);
  float shorter = abs(across.x * along.y - across.y * along.x) / longer;
  float taps = clamp(ceil(longer / max(shorter, 1.0)), 1.0, 4.0);
  float detail = clamp(log2(max(max(longer / taps, shorter), 1.0)), 0.0, float(head.y - 1u));
  int level = int(head.x) + int(detail), coarser = min(level + 1, int(head.x + head.y) - 1);
  vec2 way = (length(across) > length(along) ? right : up) / taps;
  vec3 sum = vec3(0.0);
  float taken = 0.0;
  do {
    vec2 place = at + (taken - 0.5 * (taps - 1.0)) * way;
    sum += mix(level_color(level, head.zw, place), level_color(coarser, head.zw, place), fract(detail));
    taken += 1.0;
  } while (taken < taps);
  return sum / taps;
}
