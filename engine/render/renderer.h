// Draws a stage with OpenGL 3.3: key light with shadow map, fill, rim and sky light, a ground that fades into the
// background, and captions. All functions are called on the thread that made the renderer.
//
// What each pixel shows is found first, as numbers of triangles (visibility.h). OpenGL then shades each pixel once, and
// twice only where different surfaces meet. So neither small triangles nor hidden ones cost shading.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "render/captions.h"
#include "render/draw_list.h"
#include "render/gl_context.h"
#include "render/gl_table.h"
#include "render/graphs.h"
#include "render/ground.h"
#include "render/legend.h"
#include "render/marks.h"
#include "render/overlays.h"
#include "render/passes.h"
#include "render/program.h"
#include "render/shadow_map.h"
#include "render/stage_cover.h"
#include "render/subtitles.h"
#include "render/surface_buffers.h"
#include "render/texture_buffer.h"
#include "render/tile_buffer.h"
#include "render/visibility.h"

namespace supple {

class Renderer {
 public:
  // Throws RunError when no context can be created, and when shaders do not compile.
  Renderer(const Stage& stage, GlChoice choice, const std::filesystem::path& shaders);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image draw(const DrawList& list);
  // Returns passes of the list that was drawn last (passes.h). next: the list of the next picture, or null.
  // They are those of the frame's own time, all sharp, whatever the picture is exposed to.
  std::vector<PassImage> passes(const DrawList& list, const DrawList* next, std::span<const PicturePass> asked);

  std::string backend() const { return context_.backend(); }
  const std::string& name() const { return name_; }        // GL_RENDERER
  const std::string& version() const { return version_; }  // GL_VERSION

 private:
  // Tells whether bodies and what lights cover are those of the picture before.
  enum class Motion { moved, same };
  // Describes what the last picture without exposure showed, and holds it without words.
  struct Moment {
    DrawList list;  // without what changes the stage, and without words
    StageCover::Frame cover;
    Image image;
  };

  void make_targets();
  void make_shading_program();
  void make_rim_shadows();
  void prepare_field();
  void make_surfaces();
  void take_samples(int samples);
  void take_changes(const DrawList& list);
  Image draw_sharp(const DrawList& list);
  Image draw_moment(const DrawList& list, const StageCover::Frame& cover, Motion motion);
  Image draw_exposed(const DrawList& list);
  void find_visible(const Eigen::Matrix4f& view, const StageLight& light, const DrawList& list);
  void shade(const StageLight& light);
  void draw_overlays(const DrawList& list, Image& image);
  void draw_marks(const Eigen::Matrix4f& view, const DrawList& list);
  void clear_picture();
  Image read_picture();
  void read_coverage(Image& image) const;

  Stage stage_;
  std::filesystem::path shaders_;
  GlContext context_;
  GlTable gl_;
  std::string name_, version_;
  StageCover cover_;
  GLuint visible_ = 0;  // see Visibility::surfaces()
  GLuint picture_framebuffer_ = 0, picture_color_ = 0;
  std::unique_ptr<Program> shading_program_;
  std::vector<std::string> definitions_;  // of the shading program
  std::unique_ptr<TextureBuffer> textures_;
  std::unique_ptr<SurfaceBuffers> surfaces_;
  int samples_ = 0;  // samples a pixel of visibility_ and of the shading program
  std::unique_ptr<Visibility> visibility_;
  std::unique_ptr<Visibility> sharp_;  // for passes of blurred pictures; made when they are first asked for
  std::unique_ptr<ShadowMap> shadows_;
  std::unique_ptr<ShadowMap> rim_shadows_;  // of the rim light, once something is translucent
  std::unique_ptr<Ground> ground_;          // where something of it is seen
  OverlayPlaces overlays_;
  std::unique_ptr<Captions> captions_;
  std::unique_ptr<Graphs> graphs_;
  std::unique_ptr<Subtitles> subtitles_;
  std::unique_ptr<Marks> marks_;  // once there is one to draw
  std::unique_ptr<TileBuffer> tile_buffer_;
  GLuint color_buffer_ = 0, color_texture_ = 0;  // colours of the field; none without a field
  Sticker legend_;
  std::optional<Moment> last_;        // nothing where the stage has changed since, or the last picture was exposed
  std::vector<std::uint8_t> pixels_;  // scratch: the picture as it is read back
};

}  // namespace supple
