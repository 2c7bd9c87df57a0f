// Shades a surface by its roughness: facets that lie in all directions reflect lamps and sky.
const float lamp_radius = 0.07;           // of a lamp, as the half vector sees it: half its angle [radians]
const float reflected_head_on = 0.04;     // of plastic, skin and water

// Returns the share of a lamp's light that facets reflect to the eye, where 1 is what a white matt surface would reflect
// that faces the lamp: the distribution GGX (Walter et al. 2007, "Microfacet models for refraction", equation 33) with
// the square of the roughness for its width (Burley 2012, "Physically-based shading at Disney"), Smith's masking as
// Hammon (2017, "PBR diffuse lighting for GGX+Smith microsurfaces") has it, and Fresnel's factor as Schlick (1994).
// A lamp is a disc, so that the narrowest highlight is as wide as that, and as that of a gloss of 1.
float facets(vec3 n, vec3 v, vec3 to_lamp, float roughness) {
  vec3 h = normalize(to_lamp + v);
  float lamp = max(dot(n, to_lamp), 0.0), sees = max(dot(n, v), 1e-3), half_way = max(dot(n, h), 0.0);
  float width = sqrt(roughness * roughness * roughness * roughness + lamp_radius * lamp_radius);
  float spread = half_way * half_way * (width * width - 1.0) + 1.0;
  float facing = width * width / (spread * spread);  // pi times the distribution
  float unmasked = 0.5 / max(mix(2.0 * lamp * sees, lamp + sees, width), 1e-4);
  float grazing = 1.0 - max(dot(v, h), 0.0);
  float fresnel = reflected_head_on + (1.0 - reflected_head_on) * grazing * grazing * grazing * grazing * grazing;
  return fresnel * facing * unmasked * lamp;
}

// Returns the light of the sky and the ground that facets reflect to the eye: the share of all directions as Karis (2014,
// "Physically based shading on mobile") fits it, and the colour of a horizon that a rough surface blurs.
vec3 mirrored_sky(vec3 n, vec3 v, float roughness) {
  float sees = max(dot(n, v), 0.0);
  vec4 fit = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float bent = min(fit.x * fit.x, exp2(-9.28 * sees)) * fit.x + fit.y;
  float share = reflected_head_on * (fit.z - 1.04 * bent) + fit.w + 1.04 * bent;
  float blur = 0.15 + roughness;
  return share * mix(0.55 * ground_color, sky_color, smoothstep(-blur, blur, reflect(-v, n).y));
}

// Returns what lamps and sky leave on a surface. lit: the share of the key light that reaches it; open: of the sky.
vec3 reflections(vec3 n, vec3 v, float roughness, float lit, float open) {
  return key_color * lit * facets(n, v, key_direction, roughness) + fill_color * open * facets(n, v, normalize(TO_FILL), roughness) +
         rim_color * open * facets(n, v, normalize(TO_RIM), roughness) + open * mirrored_sky(n, v, roughness);
}
