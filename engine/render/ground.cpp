#include "render/ground.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace supple {

Ground::Ground(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, double largest_body,
               GroundShown shown)
    : gl_(gl),
      arriving_(gl, shaders, "tiles", "ground_light"),
      width_(width),
      height_(height),
      shown_(shown),
      shade_(width, height, shown),
      occlusion_(largest_body),
      tiles_(width, height),
      shadows_(width, height),
      tile_buffer_(gl),
      lit_(std::size_t(shade_.light_width()) * shade_.light_height()),
      empty_(shown == GroundShown::all ? std::size_t(width) * height : 0) {
  gl_.GenTextures(1, &light_texture_);
  gl_.BindTexture(GL_TEXTURE_2D, light_texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R16, shade_.light_width(), shade_.light_height(), 0, GL_RED, GL_UNSIGNED_SHORT,
                 nullptr);
  gl_.GenFramebuffers(1, &light_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, light_framebuffer_);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light_texture_, 0);
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw RunError(fmt::format("OpenGL cannot draw into a picture of {} x {} pixels", width, height));
}

Ground::~Ground() {
  gl_.DeleteFramebuffers(1, &light_framebuffer_);
  gl_.DeleteTextures(1, &light_texture_);
}

// Copies the bare ground into the picture, after computing it again where something about it has changed. Empties the
// picture where only shadows are shown.
void Ground::begin_picture(const Bare& now) {
  if (shown_ == GroundShown::shadows) {
    picture_.assign(std::size_t(width_) * height_, 0);
    return;
  }
  if (!bare_ || *bare_ != now) {
    tiles_.clear();
    for (int row = 0; row < tiles_.rows(); ++row) {
      for (int column = 0; column < tiles_.columns(); ++column) tiles_.mark(column, row);
    }
    shade_.shade_bare(tiles_, empty_);
    bare_ = now;
  }
  picture_ = empty_;
}

// Marks where the shadows of all triangles fall on the ground.
void Ground::mark_shadows(const Eigen::Matrix4f& view, const StageLight& light, double penumbra,
                          const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& positions) {
  const auto across_x = static_cast<float>(light.to_key.x() / light.to_key.y());
  const auto across_z = static_cast<float>(light.to_key.z() / light.to_key.y());
  // The widest border of a shadow is a disc in front of the light, which the ground stretches.
  const double around = penumbra / light.to_key.y();
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::vector<float>& points = positions[m];
    cast_.resize(points.size());
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      const float height = std::max(points[i + 1], 0.0f);
      cast_[i] = points[i] - height * across_x;
      cast_[i + 1] = 0;
      cast_[i + 2] = points[i + 2] - height * across_z;
    }
    const bool fewer = !meshes[m].shadow_triangles.empty();
    shadows_.mark(cast_, fewer ? meshes[m].shadow_triangles : meshes[m].triangles, view, around);
  }
}

// Marks where bodies hide a part of the sky from the ground that can be seen.
void Ground::mark_occlusion(const Eigen::Matrix4f& view, const std::vector<float>& open) {
  constexpr float seen = 1 - GroundOcclusion::unseen;
  const double cell = occlusion_.extent() / GroundOcclusion::cells;
  std::vector<float> corners;
  std::vector<std::uint32_t> triangles;
  for (int v = 0; v < GroundOcclusion::cells; ++v) {
    for (int u = 0; u < GroundOcclusion::cells; ++u) {
      if (open[std::size_t(v) * GroundOcclusion::cells + u] >= seen) continue;
      const auto x = static_cast<float>(occlusion_.origin_x() + (u + 0.5) * cell);
      const auto z = static_cast<float>(occlusion_.origin_z() + (v + 0.5) * cell);
      const auto wide = static_cast<float>(2 * cell);  // a cell is blended into two neighbours on each side
      const auto first = static_cast<std::uint32_t>(corners.size() / 3);
      corners.insert(corners.end(),
                     {x - wide, 0, z - wide, x + wide, 0, z - wide, x - wide, 0, z + wide, x + wide, 0, z + wide});
      triangles.insert(triangles.end(), {first, first + 1, first + 2, first + 1, first + 2, first + 3});
    }
  }
  tiles_.mark(corners, triangles, view);
}

void Ground::draw(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light, const ShadowMap& shadows,
                  const StageCover::Frame& cover, const std::vector<DrawMesh>& meshes,
                  const std::vector<std::vector<float>>& positions, const Tiles& covered) {
  const Vec3 stage(cover.light_center.x(), cover.light_center.z(), cover.light_radius);
  shade_.set_stage(light, stage);
  begin_picture({view, stage, {light.ground, light.background, light.exposure}});
  const std::vector<float>& open = occlusion_.compute(meshes, positions, cover.shade_center, cover.shade_extent);
  occlusion_.smooth();
  tiles_.clear();
  shadows_.clear();
  mark_shadows(view, light, shadows.widest_penumbra(), meshes, positions);
  mark_occlusion(view, open);
  tiles_.mark(shadows_);
  // Pixels on the border of a tile take light from the tile beside it.
  Tiles hidden = covered;
  hidden.narrow();
  shadows_.unmark(hidden);
  tiles_.unmark(covered);
  find_shadows(light, shadows);
  shade_.shade(tiles_, lit_, occlusion_, picture_);
  gl_.BindTexture(GL_TEXTURE_2D, picture);
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, picture_.data());
}

// Finds the light in the tiles that shadows may reach.
void Ground::find_shadows(const StageLight& light, const ShadowMap& shadows) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, light_framebuffer_);
  gl_.Viewport(0, 0, shade_.light_width(), shade_.light_height());
  gl_.ClearColor(1, 1, 1, 1);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
  arriving_.use();
  set_light(arriving_, light);
  shadows.bind(arriving_, 0);
  tile_buffer_.draw(shadows_.corners());
  std::ranges::fill(lit_, std::uint16_t{0xffff});
  const Tiles::Area box = shadows_.around();
  if (box.width == 0) return;
  const int left = box.left / 2, low = box.low / 2;
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 2);
  gl_.PixelStorei(GL_PACK_ROW_LENGTH, shade_.light_width());
  gl_.ReadPixels(left, low, (box.width + 1) / 2, (box.height + 1) / 2, GL_RED, GL_UNSIGNED_SHORT,
                 &lit_[std::size_t(low) * shade_.light_width() + left]);
  gl_.PixelStorei(GL_PACK_ROW_LENGTH, 0);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 4);
}

}  // namespace supple
