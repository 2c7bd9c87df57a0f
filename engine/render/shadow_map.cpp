#include "render/shadow_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "render/view.h"

namespace supple {
namespace {

// The light is a disc that is seen under this angle from the stage: at a distance d behind the object that casts it,
// the border of a shadow is 2 d tan(angle) wide.
constexpr double tan_of_light = 0.14;

constexpr int taps = 12;  // in the border of a shadow; pixels share those of their block of 2 x 2

}  // namespace

ShadowMap::ShadowMap(const GlTable& gl, const std::filesystem::path& shaders, double largest_body, const Vec3& to_light,
                     int width)
    : gl_(gl),
      program_(gl, shaders, "shadow", "shadow"),
      to_light_(to_light),
      offset_(0.0058 * largest_body),
      widest_(0.036 * largest_body),
      edge_(std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(width))) / 2, 512, 4096)) {
  gl_.GenTextures(1, &texture_);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, edge_, edge_, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  for (const auto& [key, value] : {std::pair{GL_TEXTURE_MIN_FILTER, GL_NEAREST},
                                   {GL_TEXTURE_MAG_FILTER, GL_NEAREST},
                                   {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE},
                                   {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE}}) {
    gl_.TexParameteri(GL_TEXTURE_2D, key, value);
  }
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw RunError(fmt::format("OpenGL cannot draw into a shadow map of {0} x {0} pixels", edge_));
}

ShadowMap::~ShadowMap() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteTextures(1, &texture_);
}

void ShadowMap::draw(const SurfaceBuffers& surfaces, const std::vector<DrawMesh>& meshes, const Vec3& center,
                     double radius) {
  radius_ = radius;
  Eigen::Matrix4f project = Eigen::Matrix4f::Identity();
  project(0, 0) = project(1, 1) = static_cast<float>(1 / radius_);
  project(2, 2) = static_cast<float>(-1 / radius_);  // covers depths from radius to 3 radius before the light's eye
  project(2, 3) = -2;
  matrix_ = project * look_at(center + 2 * radius_ * to_light_, center);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, edge_, edge_);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(2.0f, 4.0f);
  program_.use();
  program_.set("light_matrix", matrix_);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].ghost) continue;
    // Closed bodies hide their far sides, which need not be drawn.
    meshes[m].two_sided ? gl_.Disable(GL_CULL_FACE) : gl_.Enable(GL_CULL_FACE);
    surfaces.draw_caster(m);
  }
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_DEPTH_TEST);
}

void ShadowMap::bind(const Program& program, int unit) const {
  const double texel = 2 * radius_ / edge_;  // [m]
  program.set_texture("shadow_map", unit, GL_TEXTURE_2D, texture_);
  program.set("light_matrix", matrix_);
  program.set("shadow_offset", offset_);
  program.set("map_texels", edge_);
  program.set("map_depth", 2 * radius_);
  program.set("widest_penumbra", widest_ / texel);
  program.set("penumbra_slope", tan_of_light * edge_);  // the depths run over the length of an edge
  program.set("most_taps", taps);
  // Where all wide taps meet something, a little light may still pass between them. In a large picture the border of
  // that place would be seen as a row of blocks, so that all points take the narrow taps there.
  constexpr int large = 2048;
  program.set("surely_casters", edge_ < large ? 3.9 : 4.1);
}

void ShadowMap::bind_depths(const Program& program, const char* sampler, const char* matrix, int unit) const {
  program.set_texture(sampler, unit, GL_TEXTURE_2D, texture_);
  program.set(matrix, matrix_);
}

}  // namespace supple
