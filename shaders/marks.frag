#version 330 core
// A handle's mark is a square, a contact's a disc; a light border separates it from any background.
in vec2 corner;
flat in float kind;
uniform float half_edge;  // in pixels
out vec4 pixel;

void main() {
  bool handle = kind < 0.5;
  float away = (handle ? max(abs(corner.x), abs(corner.y)) : length(corner)) * half_edge;
  float cover = clamp(half_edge - away, 0.0, 1.0), inside = clamp(half_edge - 0.8 - away, 0.0, 1.0);
  vec3 color = handle ? vec3(0.13, 0.30, 0.62) : vec3(0.85, 0.33, 0.10);
  pixel = vec4(mix(vec3(0.97), color, inside) * cover, cover);
}
