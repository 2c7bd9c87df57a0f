#version 330 core
// Draws a small square for each mark, where the surface in front of it does not hide it.
#if SAMPLES > 1
#define SampledDepths sampler2DMS
#else
#define SampledDepths sampler2D
#endif
uniform mat4 view_matrix;
uniform samplerBuffer marks;    // x y z, and the kind
uniform SampledDepths depths;   // of the bodies
uniform vec3 depth_scale;       // see DepthScale; the third is how far behind the surface a mark may lie
uniform vec3 picture;           // its width and height, and half the edge of a mark, in pixels
out vec2 corner;
flat out float kind;

void main() {
  vec4 mark = texelFetch(marks, gl_VertexID / 6);
  vec4 clip = view_matrix * vec4(mark.xyz, 1.0);
  vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * picture.xy;
  ivec2 pixel = clamp(ivec2(at), ivec2(0), ivec2(picture.xy) - 1);
  float before = depth_scale.x / (depth_scale.y - texelFetch(depths, pixel, 0).r);
  bool hidden = clip.w <= 0.0 || before < clip.w - depth_scale.z;
  corner = vec2[6](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1))[gl_VertexID % 6];
  kind = mark.w;
  vec2 place = (at + corner * picture.z) / picture.xy * 2.0 - 1.0;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(place, 0.0, 1.0);
}
