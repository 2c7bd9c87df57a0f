#version 330 core
uniform uint first;  // number of the mesh's first triangle
out uint triangle;
void main() { triangle = first + uint(gl_PrimitiveID); }
