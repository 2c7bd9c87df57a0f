#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view_matrix;
out float gl_ClipDistance[1];
void main() {
  gl_ClipDistance[0] = position.y + 1e-4;  // what lies below the ground is not seen
  gl_Position = view_matrix * vec4(position, 1.0);
}
