#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in float patch_number;
uniform mat4 view_matrix;
flat out uint smooth_patch;
out float gl_ClipDistance[1];
void main() {
  smooth_patch = uint(patch_number) << 24;
  gl_ClipDistance[0] = position.y + 1e-4;  // what lies below the ground is not seen
  gl_Position = view_matrix * vec4(position, 1.0);
}
