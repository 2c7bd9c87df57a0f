// Draws the seamless ground and the background behind it. The parts on which bodies have no effect are drawn once and
// copied into each frame; each frame draws again only the part of the ground that shadows may reach. The light that
// arrives there is computed at half the picture's resolution, because it changes little from pixel to pixel.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "render/draw_list.h"
#include "render/ground_occlusion.h"
#include "render/light_rig.h"
#include "render/program.h"
#include "render/shadow_map.h"
#include "render/stage_cover.h"
#include "render/tile_buffer.h"
#include "render/tiles.h"
#include "render/view.h"

namespace supple {

// Holds what every shader that lights a surface needs: the light, the camera and the colours of the stage.
struct StageLight {
  LightRig rig;
  Vec3 to_key;  // unit vector towards the key light
  Camera camera;
  Vec3 background, ground;  // linear
  double exposure;
  Rays rays;
};

// Passes the lights and rays to a program whose shader includes film.glsl and lighting.glsl.
void set_light(const Program& program, const StageLight& light);

// Chooses what pictures have of the ground: all that is seen of it, or its shadows alone, as black with the coverage
// that darkens a picture of the open ground as much as the shadow does.
enum class GroundShown { all, shadows };

class Ground {
 public:
  // largest_body: diagonal of the largest body [m].
  Ground(const GlTable& gl, const std::filesystem::path& shaders, int width, int height, double largest_body,
         GroundShown shown);
  ~Ground();
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  // Fills the picture's framebuffer, except for the tiles that bodies cover.
  void draw(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light, const ShadowMap& shadows,
            const StageCover::Frame& cover, const std::vector<DrawMesh>& meshes,
            const std::vector<std::vector<float>>& positions, const Tiles& covered);

 private:
  void begin_picture(GLuint picture, const Eigen::Matrix4f& view, const StageLight& light);
  void draw_bare(const Eigen::Matrix4f& view, const StageLight& light);
  void mark_shadows(const Eigen::Matrix4f& view, const StageLight& light, double penumbra,
                    const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& positions);
  void mark_occlusion(const Eigen::Matrix4f& view, const std::vector<float>& open);
  void draw_arriving(const StageLight& light, const ShadowMap& shadows, const std::vector<float>& open);
  void set_stage(const Program& program, const StageLight& light) const;

  const GlTable& gl_;
  Program bare_, arriving_, arriving_unshadowed_, shadowed_, open_;
  int width_, height_;
  GroundShown shown_;
  Vec3 lit_ = Vec3(0, 0, 1);  // centre x, z and radius of the stage in the frame in hand [m]
  GroundOcclusion occlusion_;
  Tiles tiles_;       // those that shadows may reach
  Tiles open_tiles_;  // those of the others that have a body above them
  TileBuffer tile_buffer_;
  GLuint framebuffer_ = 0, color_ = 0;        // the bare ground and background
  GLuint light_framebuffer_ = 0, light_ = 0;  // key light and open sky, at half the resolution
  GLuint occlusion_texture_ = 0;
  std::optional<Eigen::Matrix4f> bare_view_;  // the view with which the bare ground was drawn
  Vec3 bare_lit_;                             // the stage with which it was drawn, as `lit_`
  StageColors bare_colors_;                   // the colours with which it was drawn, linear
  std::vector<float> cast_;                   // scratch: a mesh's shadow on the ground
};

}  // namespace supple
