#include "render/ground.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace supple {

void set_light(const Program& program, const StageLight& light) {
  program.set("key_direction", light.to_key);
  program.set("eye", light.camera.eye);
  program.set("background", light.background);
  program.set("ground_color", light.ground);
  program.set("exposure", light.exposure);
  program.set("key_color", light.rig.key);
  program.set("fill_color", light.rig.fill);
  program.set("rim_color", light.rig.rim);
  program.set("sky_color", light.rig.sky);
  program.set("key_share", light.rig.key_share);
  program.set("sky_share", light.rig.sky_share);
  program.set("ray_corner", light.rays.corner);
  program.set("ray_right", light.rays.right);
  program.set("ray_up", light.rays.up);
}

namespace {

std::vector<std::string> shading(GroundShown shown, bool shadowed) {
  std::vector<std::string> definitions = {"SHADED"};
  if (shadowed) definitions.emplace_back("SHADOWED");
  if (shown == GroundShown::shadows) definitions.emplace_back("SHADOWS_ALONE");
  return definitions;
}

}  // namespace

Ground::Ground(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, double largest_body,
               GroundShown shown)
    : gl_(gl),
      bare_(gl, shaders, "tiles", "ground"),
      arriving_(gl, shaders, "tiles", "ground_light"),
      arriving_unshadowed_(gl, shaders, "tiles", "ground_light", {"UNSHADOWED"}),
      shadowed_(gl, shaders, "tiles", "ground", shading(shown, true)),
      open_(gl, shaders, "tiles", "ground", shading(shown, false)),
      width_(width),
      height_(height),
      shown_(shown),
      occlusion_(largest_body),
      tiles_(width, height),
      open_tiles_(width, height),
      tile_buffer_(gl) {
  const auto check = [&] {
    if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw RunError(fmt::format("OpenGL cannot draw into a picture of {} x {} pixels", width, height));
  };
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.GenRenderbuffers(1, &color_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, color_);
  gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_RGBA8, width, height);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  check();
  const auto smooth_texture = [this](GLuint& texture) {
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(GL_TEXTURE_2D, texture);
    for (const auto& [key, value] : {std::pair{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
                                     {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
                                     {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE},
                                     {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE}}) {
      gl_.TexParameteri(GL_TEXTURE_2D, key, value);
    }
  };
  smooth_texture(occlusion_texture_);
  smooth_texture(light_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RG16, (width + 1) / 2, (height + 1) / 2, 0, GL_RG, GL_UNSIGNED_SHORT, nullptr);
  gl_.GenFramebuffers(1, &light_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, light_framebuffer_);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light_, 0);
  check();
}

Ground::~Ground() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(1, &color_);
  gl_.DeleteFramebuffers(1, &light_framebuffer_);
  gl_.DeleteTextures(1, &light_);
  gl_.DeleteTextures(1, &occlusion_texture_);
}

void Ground::set_stage(const Program& program, const StageLight& light) const {
  program.use();
  set_light(program, light);
  program.set("stage", lit_);
}

void Ground::draw_bare(const Eigen::Matrix4f& view, const StageLight& light) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, width_, height_);
  set_stage(bare_, light);
  tile_buffer_.draw({-1, -1, 3, -1, -1, 3});  // a triangle that holds the picture
  bare_view_ = view;
  bare_lit_ = lit_;
  bare_colors_ = {light.ground, light.background, light.exposure};
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
    tiles_.mark(cast_, fewer ? meshes[m].shadow_triangles : meshes[m].triangles, view, around);
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
      const auto wide = static_cast<float>(2 * cell);  // the shader blends a texel into two neighbours on each side
      const auto first = static_cast<std::uint32_t>(corners.size() / 3);
      corners.insert(corners.end(),
                     {x - wide, 0, z - wide, x + wide, 0, z - wide, x - wide, 0, z + wide, x + wide, 0, z + wide});
      triangles.insert(triangles.end(), {first, first + 1, first + 2, first + 1, first + 2, first + 3});
    }
  }
  open_tiles_.mark(corners, triangles, view);
}

// Copies the bare ground into the picture, after drawing it again where something about it has changed. Empties the
// picture where only shadows are shown.
void Ground::begin_picture(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light) {
  if (shown_ == GroundShown::shadows) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, picture);
    gl_.ClearColor(0, 0, 0, 0);
    gl_.Clear(GL_COLOR_BUFFER_BIT);
    return;
  }
  const StageColors colors = {light.ground, light.background, light.exposure};
  if (!bare_view_ || *bare_view_ != view || bare_lit_ != lit_ || bare_colors_ != colors) draw_bare(view, light);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, picture);
  gl_.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Ground::draw(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light, const ShadowMap& shadows,
                  const StageCover::Frame& cover, const std::vector<DrawMesh>& meshes,
                  const std::vector<std::vector<float>>& positions, const Tiles& covered) {
  lit_ = Vec3(cover.light_center.x(), cover.light_center.z(), cover.light_radius);
  begin_picture(picture, view, light);
  const std::vector<float>& open = occlusion_.compute(meshes, positions, cover.shade_center, cover.shade_extent);
  tiles_.clear();
  open_tiles_.clear();
  mark_shadows(view, light, shadows.widest_penumbra(), meshes, positions);
  mark_occlusion(view, open);
  open_tiles_.unmark(tiles_);
  // Pixels on the border of a tile take light from the tile beside it.
  Tiles hidden = covered;
  hidden.narrow();
  for (Tiles* tiles : {&tiles_, &open_tiles_}) tiles->unmark(hidden);
  draw_arriving(light, shadows, open);
  for (Tiles* tiles : {&tiles_, &open_tiles_}) tiles->unmark(covered);

  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture);
  gl_.Viewport(0, 0, width_, height_);
  for (const auto& [program, tiles] : {std::pair{&shadowed_, &tiles_}, {&open_, &open_tiles_}}) {
    set_stage(*program, light);
    program->set_texture("arriving", 0, GL_TEXTURE_2D, light_);
    tile_buffer_.draw(tiles->corners());
  }
}

// Finds the light in all tiles. Shadows are looked for only where there may be one.
void Ground::draw_arriving(const StageLight& light, const ShadowMap& shadows, const std::vector<float>& open) {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, occlusion_texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, GroundOcclusion::cells, GroundOcclusion::cells, 0, GL_RED, GL_FLOAT,
                 open.data());
  gl_.BindFramebuffer(GL_FRAMEBUFFER, light_framebuffer_);
  gl_.Viewport(0, 0, (width_ + 1) / 2, (height_ + 1) / 2);
  gl_.ClearColor(1, 1, 1, 1);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
  for (const bool shadowed : {true, false}) {
    const Program& program = shadowed ? arriving_ : arriving_unshadowed_;
    set_stage(program, light);
    program.set("occlusion_area", Vec3(occlusion_.origin_x(), occlusion_.origin_z(), occlusion_.extent()));
    program.set("unseen", double(GroundOcclusion::unseen));
    program.set_texture("occlusion_map", 0, GL_TEXTURE_2D, occlusion_texture_);
    if (shadowed) shadows.bind(program, 1);
    tile_buffer_.draw((shadowed ? tiles_ : open_tiles_).corners());
  }
}

}  // namespace supple
