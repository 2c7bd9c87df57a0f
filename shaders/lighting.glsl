// The lamps are a key light that casts the shadow, a fill from the right, a rim light from the back, and the sky
// (engine/render/light_rig.h).
uniform vec3 key_direction;
uniform vec3 eye;
uniform vec3 ground_color;  // linear
uniform vec3 ray_corner, ray_right, ray_up;  // directions from the eye; see Rays

uniform vec3 key_color, fill_color, rim_color, sky_color;  // linear
