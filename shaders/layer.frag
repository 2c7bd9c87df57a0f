#version 330 core
in vec2 at;
uniform sampler2D layer;
out vec4 pixel;
void main() { pixel = texture(layer, at); }
