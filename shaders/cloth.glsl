// Shades woven cloth: its two sides, its yarns as far as pixels are fine enough for them, its hem and its sheen.
uniform samplerBuffer flats;  // by vertex: place along the two axes of the flat cloth, and from its open border [m]

bool is_cloth(Seen seen) { return texelFetch(materials, seen.material + 18).w > 0.5; }

// Returns the colour of the back where the scene has none for it: a darker and paler tone of the front's.
vec3 tone_of_back(vec3 front) {
  float grey = dot(front, vec3(0.2126, 0.7152, 0.0722));  // luminance of BT.709
  return 0.68 * mix(front, vec3(grey), 0.3);
}

vec3 along(vec3 way) { return way / max(length(way), 1e-12); }

// Bends the normal over the yarns of a plain weave, and darkens the gaps between them. Before the yarns along an axis
// become narrower than three pixels they have faded to their mean, so that they make no moire. pixel: over a yarn.
void weave(inout Seen seen, inout vec3 albedo, vec2 at, vec2 pixel, vec3 first_axis, vec3 second_axis) {
  vec2 clear = clamp(3.6 - 12.0 * pixel, 0.0, 1.0);
  vec2 within = fract(at) - 0.5;
  // Of the yarns that cross, those along the first axis lie above in every second place.
  float above = mod(floor(at.x) + floor(at.y), 2.0) < 0.5 ? 1.0 : -1.0;
  above *= min(clear.x, clear.y);
  // A yarn is round across, and bends down to both ends where it goes below the next one.
  vec2 tilt = clear * within * (1.1 + vec2(-0.4, 0.4) * above);
  seen.normal = normalize(seen.normal + tilt.x * first_axis + tilt.y * second_axis);
  const float mean = 0.23;  // of a gap, over a yarn
  vec2 gap = mix(vec2(mean), smoothstep(0.28, 0.5, abs(within)), clear);
  vec2 dark = gap * (0.33 + vec2(-0.12, 0.12) * above);
  albedo *= (1.0 - dark.x) * (1.0 - dark.y) / ((1.0 - 0.33 * mean) * (1.0 - 0.33 * mean));
}

// Shapes the hem: the cloth is folded over along its border, so that it is round there and ends in a seam.
void sew(inout Seen seen, inout vec3 albedo, float inwards, float pixel, vec3 inward_axis) {
  if (inwards > 1.4 + pixel) return;
  float clear = clamp(1.6 - 1.2 * pixel, 0.0, 1.0);
  float fold = 1.0 - smoothstep(0.0, 0.35 + pixel, inwards);
  float seam = 1.0 - smoothstep(0.0, 0.16 + 0.7 * pixel, abs(inwards - 1.0));
  seen.normal = normalize(seen.normal - clear * (0.8 * fold - 0.5 * seam) * inward_axis);
  float doubled = 1.0 - smoothstep(1.0 - 0.5 * pixel, 1.0 + 0.5 * pixel, inwards);
  albedo *= (1.0 - 0.10 * doubled) * (1.0 - 0.34 * clear * seam);
}

// Returns the share of the sky that is seen from a fold, which is larger than 1 on ridges.
float open_in_fold(float hollow) { return 1.0 - hollow * (hollow > 0.0 ? 0.7 : 0.15); }

// Gives a point of a cloth the colour of its side, its yarns and its hem.
void dress(inout Seen seen, inout vec4 material) {
  vec4 back = texelFetch(materials, seen.material + 18), sizes = texelFetch(materials, seen.material + 19);
  if (seen.back) material.rgb = back.w > 1.5 ? tone_of_back(material.rgb) : back.rgb;
  seen.open *= open_in_fold(seen.hollow);
  vec3 a = texelFetch(flats, seen.corners.x).xyz, b = texelFetch(flats, seen.corners.y).xyz, c = texelFetch(flats, seen.corners.z).xyz;
  vec3 at = seen.weights.x * a + seen.weights.y * b + seen.weights.z * c;
  vec3 right = seen.right.x * a + seen.right.y * b + seen.right.z * c, up = seen.up.x * a + seen.up.y * b + seen.up.z * c;
  vec3 pixel = sqrt(right * right + up * up);
  vec3 to_b = b - a, to_c = c - a;
  if (sizes.x > 0.0)
    weave(seen, material.rgb, at.xy / sizes.x, pixel.xy / sizes.x,
          along(to_b.x * seen.slope_b + to_c.x * seen.slope_c), along(to_b.y * seen.slope_b + to_c.y * seen.slope_c));
  if (sizes.y > 0.0)
    sew(seen, material.rgb, at.z / sizes.y, pixel.z / sizes.y, along(to_b.z * seen.slope_b + to_c.z * seen.slope_c));
}

// Returns the light that fibres which stand off the cloth scatter at grazing angles: the distribution of Estevez and Kulla
// (2017, "Production friendly microfacet sheen BRDF") with the denominator of Neubelt and Pettineo (2013,
// "Crafting a next-gen material pipeline for The Order: 1886", cloth).
vec3 sheen(vec3 n, vec3 v, vec3 albedo, float lit, float open) {
  const float roughness = 0.35;
  vec3 h = normalize(key_direction + v);
  float towards_half = dot(n, h), lights = max(dot(n, key_direction), 0.0), sees = max(dot(n, v), 0.0);
  float sine = sqrt(max(1.0 - towards_half * towards_half, 0.0));
  float spread = (2.0 + 1.0 / roughness) * pow(sine, 1.0 / roughness) / 6.2832;
  float fibres = spread / (4.0 * max(lights + sees - lights * sees, 0.05));
  vec3 tint = mix(albedo, vec3(1.0), 0.25);
  float away = 1.0 - sees;
  return tint * (0.4 * key_color * fibres * lights * lit + 0.22 * sky_color * away * away * away * open);
}
