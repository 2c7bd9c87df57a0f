// Draws the ground and the background behind it into a picture. The parts on which bodies have no effect are computed
// once and copied into each frame; each frame computes again only the part of the ground that shadows may reach. OpenGL
// finds the light that arrives there, from the shadow map, at half the picture's resolution.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "render/draw_list.h"
#include "render/ground_occlusion.h"
#include "render/ground_shade.h"
#include "render/program.h"
#include "render/shadow_map.h"
#include "render/stage_cover.h"
#include "render/stage_light.h"
#include "render/tile_buffer.h"
#include "render/tiles.h"

namespace supple {

class Ground {
 public:
  // largest_body: diagonal of the largest body [m].
  Ground(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, double largest_body,
         GroundShown shown);
  ~Ground();
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  // Fills the picture, a texture of 8 bits for each of red, green, blue and coverage, except for the tiles that bodies
  // cover.
  void draw(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light, const ShadowMap& shadows,
            const StageCover::Frame& cover, const std::vector<DrawMesh>& meshes,
            const std::vector<std::vector<float>>& positions, const Tiles& covered);

 private:
  // Describes what the bare ground depends on.
  struct Bare {
    Eigen::Matrix4f view;
    Vec3 stage;          // as in GroundShade::set_stage()
    StageColors colors;  // linear
    bool operator==(const Bare&) const = default;
  };
  void begin_picture(const Bare& now);
  void mark_shadows(const Eigen::Matrix4f& view, const StageLight& light, double penumbra,
                    const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& positions);
  void mark_occlusion(const Eigen::Matrix4f& view, const std::vector<float>& open);
  void find_shadows(const StageLight& light, const ShadowMap& shadows);

  const GlTable& gl_;
  Program arriving_;
  int width_, height_;
  GroundShown shown_;
  GroundShade shade_;
  GroundOcclusion occlusion_;
  Tiles tiles_;    // those on which bodies have an effect
  Tiles shadows_;  // those that shadows may reach
  TileBuffer tile_buffer_;
  GLuint light_framebuffer_ = 0, light_texture_ = 0;
  GroundLight lit_;
  std::optional<Bare> bare_;                    // nothing before the first picture
  std::vector<std::uint32_t> empty_, picture_;  // the bare ground, and with shadows; four bytes a pixel
  std::vector<float> cast_;                     // scratch: a mesh's shadow on the ground
};

}  // namespace supple
