#version 330 core
uniform uint first;  // number of the mesh's first triangle
flat in uint smooth_patch;
out uint triangle;
void main() { triangle = smooth_patch | (first + uint(gl_PrimitiveID)); }
