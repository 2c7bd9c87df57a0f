#version 330 core
// Draws a small square for each mark.
uniform mat4 view_matrix;
uniform samplerBuffer marks;  // x y z, and the kind
uniform vec3 picture;         // its width and height, and half the edge of a mark, in pixels
out vec2 corner;
flat out float kind;

void main() {
  vec4 mark = texelFetch(marks, gl_VertexID / 6);
  vec4 clip = view_matrix * vec4(mark.xyz, 1.0);
  vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * picture.xy;
  corner = vec2[6](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1))[gl_VertexID % 6];
  kind = mark.w;
  gl_Position = vec4((at + corner * picture.z) / picture.xy * 2.0 - 1.0, 0.0, 1.0);
}
