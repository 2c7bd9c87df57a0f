// Draws a stage with OpenGL 3.3: key light with shadow map, fill, rim and sky light, a ground that fades into the
// background, and captions. All functions are called on the thread that made the renderer.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "render/draw_list.h"
#include "render/gl_context.h"
#include "render/gl_table.h"
#include "render/ground_occlusion.h"
#include "render/mesh_buffers.h"

namespace supple {

class Renderer {
 public:
  // Throws RunError when there is no context, when the context is broken (a test triangle shows it), and when shaders
  // do not compile.
  Renderer(const Stage& stage, GlChoice choice, const std::filesystem::path& shaders);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image draw(const DrawList& list);

  std::string backend() const { return context_.backend(); }
  const std::string& name() const { return name_; }        // GL_RENDERER
  const std::string& version() const { return version_; }  // GL_VERSION

 private:
  struct Target {
    GLuint framebuffer = 0, color = 0, depth = 0;  // depth exists only where bodies are drawn
  };
  struct Label {
    GLuint texture = 0;
    int width = 0, height = 0;
    Vec3 anchor = Vec3::Zero();
  };

  void make_targets();
  void make_label(std::size_t mesh);
  void check_test_triangle();
  void upload(const DrawList& list);
  void draw_shadow_map();
  void draw_mesh(std::size_t mesh);
  void draw_bodies(const Camera& camera);
  void draw_ground(const Camera& camera);
  void lay_bodies_over_ground();
  void draw_labels(const Camera& camera);
  void set_lights(GLuint program, const Camera& camera) const;

  GLint uniform(GLuint program, const char* name) const { return gl_.GetUniformLocation(program, name); }

  Stage stage_;
  GlContext context_;
  GlTable gl_;
  std::string name_, version_;
  GLuint body_program_ = 0, ground_program_ = 0, shadow_program_ = 0, label_program_ = 0, backdrop_program_ = 0,
         layer_program_ = 0;
  Target bodies_;    // antialiased; transparent where there is no body
  Target resolved_;  // the same, one sample a pixel; its colour is layer_texture_
  Target picture_;
  GLuint layer_texture_ = 0;
  GLuint shadow_framebuffer_ = 0, shadow_texture_ = 0, occlusion_texture_ = 0, empty_array_ = 0;
  std::vector<MeshBuffers> meshes_;
  std::vector<Label> labels_;  // one for each mesh
  Bounds bounds_;              // bounds of the stage at rest, widened; lights and shadows cover them
  double largest_body_ = 1;
  GroundOcclusion occlusion_;
  Eigen::Matrix4f light_matrix_ = Eigen::Matrix4f::Identity();
  Vec3 key_direction_;  // towards the light
};

}  // namespace supple
