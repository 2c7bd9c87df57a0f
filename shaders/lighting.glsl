// The studio's lights are a warm key from the upper left that casts the shadow, a cool fill from the right, a rim light
// from the back, and the sky.
uniform vec3 key_direction;
uniform vec3 eye;
uniform vec3 background;    // linear
uniform vec3 ground_color;  // linear
uniform vec3 ray_corner, ray_right, ray_up;  // directions from the eye; see Rays

const vec3 key_color = vec3(2.35, 2.20, 1.98);
const vec3 fill_color = vec3(0.46, 0.54, 0.66);
const vec3 rim_color = vec3(1.15, 1.12, 1.05);
const vec3 sky_color = vec3(0.62, 0.66, 0.72);
