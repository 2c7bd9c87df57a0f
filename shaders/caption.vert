#version 330 core
uniform vec4 area;  // lower left corner and extent, in clip coordinates
out vec2 at;
void main() {
  vec2 corner = vec2[6](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(0, 1))[gl_VertexID];
  at = vec2(corner.x, 1.0 - corner.y);
  gl_Position = vec4(area.xy + corner * area.zw, 0.0, 1.0);
}
