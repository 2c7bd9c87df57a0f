// Draws the shadow map of a lamp: the distance from the light to the nearest surface. The map is orthographic; what
// it covers is told for each frame (stage_cover.h).
#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "render/program.h"
#include "render/surface_buffers.h"

namespace supple {

class ShadowMap {
 public:
  // largest_body: diagonal of the largest body [m]. to_light: unit vector. width: that of the picture in pixels, on
  // which the map's resolution depends.
  ShadowMap(const GlTable& gl, const std::filesystem::path& shaders, double largest_body, const Vec3& to_light,
            int width);
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  // Draws all meshes into the map, which covers a ball [m].
  void draw(const SurfaceBuffers& surfaces, const std::vector<DrawMesh>& meshes, const Vec3& center, double radius);

  // Passes the map and its parameters to a program whose shader includes shadow.glsl; the map uses this unit.
  void bind(const Program& program, int unit) const;

  // Passes the map alone, for another lamp than that of shadow.glsl: the map to this sampler, and the matrix that maps
  // the world to the lamp's clip coordinates.
  void bind_depths(const Program& program, const char* sampler, const char* matrix, int unit) const;

  double widest_penumbra() const { return widest_; }  // radius in the world [m]

 private:
  const GlTable& gl_;
  Program program_;
  GLuint framebuffer_ = 0, texture_ = 0;
  Vec3 to_light_;
  Eigen::Matrix4f matrix_;  // maps the world to the light's clip coordinates
  double radius_ = 0;       // of what the map covers [m]
  double offset_, widest_;  // [m]
  int edge_;                // of the map, in texels
};

}  // namespace supple
