#version 330 core
#include "film.glsl"
in vec2 at;
uniform vec3 background;
out vec4 pixel;
void main() { pixel = film(2.0 * background); }
