// Draws the captions of bodies onto the finished picture.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "render/draw_list.h"
#include "render/program.h"

namespace supple {

class Captions {
 public:
  // font: a file; there are no captions when it is empty. height: that of the picture in pixels, to which the size of
  // the letters is proportional.
  Captions(const GlTable& gl, const std::filesystem::path& shaders, std::string font, int width, int height);
  ~Captions();
  Captions(const Captions&) = delete;
  Captions& operator=(const Captions&) = delete;

  // Makes the captions of a stage again, or only that of a mesh that has changed.
  void renew(const std::vector<DrawMesh>& meshes);
  void renew(std::size_t index, const DrawMesh& mesh);

  // Draws into the framebuffer that is bound. view: maps the world to clip coordinates.
  void draw(const Eigen::Matrix4f& view) const;

 private:
  struct Label {
    GLuint texture = 0;
    int width = 0, height = 0;
    Vec3 anchor = Vec3::Zero();
  };

  const GlTable& gl_;
  Program program_;
  std::string font_;
  int width_, height_;
  GLuint array_ = 0;
  std::vector<Label> labels_;  // one for each mesh
};

}  // namespace supple
