#include "render/marks.h"

#include <algorithm>

namespace supple {

Marks::Marks(const GlTable& gl, const std::filesystem::path& shaders, int width, int height)
    : gl_(gl), program_(gl, shaders, "marks", "marks"), width_(width), height_(height) {
  gl_.GenVertexArrays(1, &array_);
  gl_.GenBuffers(1, &buffer_);
  gl_.GenTextures(1, &texture_);
}

Marks::~Marks() {
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteVertexArrays(1, &array_);
}

void Marks::draw(const std::vector<std::array<float, 4>>& marks, const Eigen::Matrix4f& view, const Visibility& visible,
                 double behind) const {
  const auto hidden = [&](const std::array<float, 4>& mark) {
    const Eigen::Vector4f clip = view * Eigen::Vector4f(mark[0], mark[1], mark[2], 1);
    const auto pixel = [&clip](float along, int pixels) {
      const float at = (along / clip.w() * 0.5f + 0.5f) * static_cast<float>(pixels);
      return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(pixels - 1)));
    };
    return clip.w() <= 0 || visible.distance(pixel(clip.x(), width_), pixel(clip.y(), height_)) < clip.w() - behind;
  };
  std::vector<std::array<float, 4>> seen;
  std::ranges::remove_copy_if(marks, std::back_inserter(seen), hidden);
  if (seen.empty()) return;
  gl_.BindBuffer(GL_TEXTURE_BUFFER, buffer_);
  gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(seen.size() * sizeof(seen[0])), seen.data(),
                 GL_STREAM_DRAW);
  program_.use();
  program_.set_texture("marks", 0, GL_TEXTURE_BUFFER, texture_);
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, buffer_);
  program_.set("view_matrix", view);
  const double half_edge = std::max(2.0, height_ / 280.0);
  program_.set("picture", Vec3(width_, height_, half_edge));
  program_.set("half_edge", half_edge);
  gl_.BindVertexArray(array_);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * seen.size()));
  gl_.Disable(GL_BLEND);
}

}  // namespace supple
