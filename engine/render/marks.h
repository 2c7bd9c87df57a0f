// Draws marks over the bodies: where handles hold vertices, and where vertices touch colliders. A mark that the bodies
// hide is not drawn.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "render/gl_table.h"
#include "render/program.h"

namespace supple {

class Marks {
 public:
  // samples: of the texture of depths.
  Marks(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, int samples);
  ~Marks();
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  // Draws into the framebuffer that is bound. marks: x y z [m] and the kind, 0 for handles and 1 for contacts.
  // depths: a texture of the kind `target`. scale: see DepthScale. behind: how far a mark may lie behind the surface
  // [m].
  void draw(const std::vector<std::array<float, 4>>& marks, const Eigen::Matrix4f& view, GLenum target, GLuint depths,
            const Eigen::Vector2d& scale, double behind) const;

 private:
  const GlTable& gl_;
  Program program_;
  int width_, height_;
  GLuint array_ = 0, buffer_ = 0, texture_ = 0;
};

}  // namespace supple
