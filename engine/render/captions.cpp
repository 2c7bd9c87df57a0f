#include "render/captions.h"

#include <algorithm>
#include <cmath>

#include "render/caption.h"

namespace supple {

Captions::Captions(const GlTable& gl, const std::filesystem::path& shaders, std::string font, int width, int height)
    : gl_(gl), program_(gl, shaders, "caption", "caption"), font_(std::move(font)), width_(width), height_(height) {
  gl_.GenVertexArrays(1, &array_);
}

Captions::~Captions() {
  for (const Label& label : labels_) gl_.DeleteTextures(1, &label.texture);
  gl_.DeleteVertexArrays(1, &array_);
}

void Captions::renew(const std::vector<DrawMesh>& meshes) {
  labels_.resize(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) renew(m, meshes[m]);
}

void Captions::renew(std::size_t index, const DrawMesh& mesh) {
  gl_.DeleteTextures(1, &labels_[index].texture);  // deleting texture 0 is no error
  labels_[index] = {};
  if (font_.empty() || mesh.label.empty()) return;
  const int pixels = std::max(9, static_cast<int>(std::lround(height_ / 32.0)));
  // The caption is placed on the ground: for a body that hangs in the air, it is moved down to a place below the body's
  // start.
  const CaptionBitmap bitmap = draw_caption(font_, mesh.label, pixels);
  Label label{0, bitmap.width, bitmap.height,
              Vec3(mesh.rest.center().x(), std::min(mesh.rest.lower.y(), 0.0), mesh.rest.upper.z())};
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.GenTextures(1, &label.texture);
  gl_.BindTexture(GL_TEXTURE_2D, label.texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, bitmap.width, bitmap.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                 bitmap.coverage.data());
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  labels_[index] = label;
}

void Captions::draw(const Eigen::Matrix4f& view) const {
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program_.use();
  gl_.BindVertexArray(array_);
  for (const Label& label : labels_) {
    if (label.texture == 0) continue;
    const Eigen::Vector4f clip = view * label.anchor.homogeneous().cast<float>();
    if (clip.w() <= 0) continue;
    // Positions are whole pixels, so that the letters stay sharp. The caption is placed below the body, or at the
    // bottom edge when there is no room.
    const double x = std::round((clip.x() / clip.w() * 0.5 + 0.5) * width_ - 0.5 * label.width);
    const double below = (clip.y() / clip.w() * 0.5 + 0.5) * height_ - 0.035 * height_;
    const double y = std::round(std::max(below - label.height, 0.01 * height_));
    program_.set("area", Eigen::Vector4d(2 * x / width_ - 1, 2 * y / height_ - 1, 2.0 * label.width / width_,
                                         2.0 * label.height / height_));
    program_.set_texture("caption", 0, GL_TEXTURE_2D, label.texture);
    gl_.DrawArrays(GL_TRIANGLES, 0, 6);
  }
  gl_.Disable(GL_BLEND);
}

}  // namespace supple
