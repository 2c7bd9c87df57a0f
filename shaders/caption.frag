#version 330 core
in vec2 at;
uniform sampler2D caption;
out vec4 pixel;
void main() { pixel = vec4(vec3(0.27), texture(caption, at).r); }
