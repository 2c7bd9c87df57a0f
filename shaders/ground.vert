#version 330 core
uniform mat4 view_matrix;
uniform vec4 stage;  // centre x, z; radius
out vec3 world;
void main() {
  vec2 corner = vec2[6](vec2(-1, -1), vec2(1, 1), vec2(1, -1), vec2(-1, -1), vec2(-1, 1), vec2(1, 1))[gl_VertexID];
  world = vec3(stage.x + 3.3 * stage.z * corner.x, 0.0, stage.y + 3.3 * stage.z * corner.y);
  gl_Position = view_matrix * vec4(world, 1.0);
}
