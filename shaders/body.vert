#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float occlusion;
layout(location = 3) in vec4 paint_low;
layout(location = 4) in vec4 paint_high;
layout(location = 5) in vec2 square;
uniform mat4 view_matrix;
out vec3 world;
out vec3 world_normal;
out float open_sky;
out vec4 layer_low;
out vec4 layer_high;
out vec2 squares;
void main() {
  world = position;
  world_normal = normal;
  open_sky = occlusion;
  layer_low = paint_low;
  layer_high = paint_high;
  squares = square;
  gl_Position = view_matrix * vec4(position, 1.0);
}
