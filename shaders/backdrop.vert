#version 330 core
out vec2 at;
void main() {
  at = vec2[3](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID];
  gl_Position = vec4(at, 1.0, 1.0);  // behind everything
}
