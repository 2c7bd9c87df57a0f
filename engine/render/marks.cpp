#include "render/marks.h"

#include <fmt/core.h>

#include <algorithm>

namespace supple {

Marks::Marks(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, int samples)
    : gl_(gl),
      program_(gl, shaders, "marks", "marks", {fmt::format("SAMPLES {}", samples)}),
      width_(width),
      height_(height) {
  gl_.GenVertexArrays(1, &array_);
  gl_.GenBuffers(1, &buffer_);
  gl_.GenTextures(1, &texture_);
}

Marks::~Marks() {
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteVertexArrays(1, &array_);
}

void Marks::draw(const std::vector<std::array<float, 4>>& marks, const Eigen::Matrix4f& view, GLenum target,
                 GLuint depths, const Eigen::Vector2d& scale, double behind) const {
  if (marks.empty()) return;
  gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer_);
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(marks.size() * sizeof(marks[0])), marks.data(),
                 GL_STREAM_DRAW);
  program_.use();
  program_.set_texture("marks", 0, GL_TEXTURE_BUFFER, texture_);
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, buffer_);
  program_.set_texture("depths", 1, target, depths);
  program_.set("view_matrix", view);
  program_.set("depth_scale", Vec3(scale.x(), scale.y(), behind));
  const double half_edge = std::max(2.0, height_ / 280.0);
  program_.set("picture", Vec3(width_, height_, half_edge));
  program_.set("half_edge", half_edge);
  gl_.BindVertexArray(array_);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * marks.size()));
  gl_.Disable(GL_BLEND);
}

}  // namespace supple
