// Draws marks over the bodies: where handles hold vertices, and where vertices touch colliders. A mark that the bodies
// hide is not drawn.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "render/gl_table.h"
#include "render/program.h"
#include "render/visibility.h"

namespace supple {

class Marks {
 public:
  Marks(const GlTable& gl, const std::filesystem::path& shaders, int width, int height);
  ~Marks();
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  // Draws into the framebuffer that is bound. marks: x y z [m] and the kind, 0 for handles and 1 for contacts. view:
  // maps the world to clip coordinates. behind: how far a mark may lie behind the surface that a pixel shows [m].
  void draw(const std::vector<std::array<float, 4>>& marks, const Eigen::Matrix4f& view, const Visibility& visible,
            double behind) const;

 private:
  const GlTable& gl_;
  Program program_;
  int width_, height_;
  GLuint array_ = 0, buffer_ = 0, texture_ = 0;
};

}  // namespace supple
