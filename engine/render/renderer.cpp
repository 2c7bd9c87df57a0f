#include "render/renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/error.h"
#include "render/caption.h"
#include "render/shader.h"
#include "render/view.h"

namespace supple {
namespace {

constexpr int shadow_map_edge = 2048;

double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

Vec3 linear_of(const Vec3& srgb) { return {linear_of(srgb.x()), linear_of(srgb.y()), linear_of(srgb.z())}; }

// Includes the ground below bodies that hang in the air, because their shadows fall there.
Bounds stage_bounds(const Stage& stage) {
  Bounds box;
  for (const DrawMesh& mesh : stage.meshes) {
    if (!mesh.framed) continue;
    box.include(mesh.rest.lower);
    box.include(mesh.rest.upper);
    box.include(Vec3(mesh.rest.lower.x(), std::min(0.0, mesh.rest.lower.y()), mesh.rest.lower.z()));
  }
  return box;
}

double largest_of(const Stage& stage) {
  double largest = 1e-6;
  for (const DrawMesh& mesh : stage.meshes)
    if (mesh.framed) largest = std::max(largest, mesh.rest.diagonal());
  return largest;
}

std::string gl_text(const GlTable& gl, GLenum what) {
  const auto* text = reinterpret_cast<const char*>(gl.GetString(what));
  return text != nullptr ? text : "";
}

}  // namespace

Renderer::Renderer(const Stage& stage, GlChoice choice, const std::filesystem::path& shaders)
    : stage_(stage),
      context_(choice),
      gl_(load_gl(context_)),
      name_(gl_text(gl_, GL_RENDERER)),
      version_(gl_text(gl_, GL_VERSION)),
      bounds_(stage_bounds(stage)),
      largest_body_(largest_of(stage)),
      occlusion_(bounds_, largest_body_),
      key_direction_(Vec3(-0.55, 1.0, 0.75).normalized()) {
  body_program_ = load_program(gl_, shaders, "body");
  ground_program_ = load_program(gl_, shaders, "ground");
  shadow_program_ = load_program(gl_, shaders, "shadow");
  label_program_ = load_program(gl_, shaders, "label");
  backdrop_program_ = load_program(gl_, shaders, "backdrop");
  layer_program_ = load_program(gl_, shaders, "layer");
  gl_.GenVertexArrays(1, &empty_array_);
  make_targets();
  check_test_triangle();
  for (const DrawMesh& mesh : stage_.meshes) meshes_.push_back(make_mesh_buffers(gl_, mesh));
  labels_.resize(stage_.meshes.size());
  for (std::size_t m = 0; m < labels_.size(); ++m) make_label(m);
  check_gl(gl_, "preparing the stage");
}

Renderer::~Renderer() {
  for (const MeshBuffers& mesh : meshes_) delete_mesh_buffers(gl_, mesh);
  for (Label& label : labels_) gl_.DeleteTextures(1, &label.texture);
  for (const GLuint program :
       {body_program_, ground_program_, shadow_program_, label_program_, backdrop_program_, layer_program_}) {
    gl_.DeleteProgram(program);
  }
  for (const Target* target : {&bodies_, &resolved_, &picture_}) {
    gl_.DeleteFramebuffers(1, &target->framebuffer);
    gl_.DeleteRenderbuffers(1, &target->color);
    gl_.DeleteRenderbuffers(1, &target->depth);
  }
  gl_.DeleteFramebuffers(1, &shadow_framebuffer_);
  gl_.DeleteTextures(1, &layer_texture_);
  gl_.DeleteTextures(1, &shadow_texture_);
  gl_.DeleteTextures(1, &occlusion_texture_);
  gl_.DeleteVertexArrays(1, &empty_array_);
}

void Renderer::make_targets() {
  const auto check = [this](const char* what) {
    const GLenum status = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
      throw RunError(fmt::format("the {} framebuffer is incomplete (0x{:04x})", what, status));
  };
  GLint most_samples = 1;
  gl_.GetIntegerv(GL_MAX_SAMPLES, &most_samples);
  const int samples = std::min(stage_.samples, most_samples);
  const auto renderbuffer = [&](GLuint& buffer, int sample_count, GLenum format, GLenum attachment) {
    gl_.GenRenderbuffers(1, &buffer);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, sample_count, format, stage_.width, stage_.height);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  };
  const auto framebuffer = [&](Target& target) {
    gl_.GenFramebuffers(1, &target.framebuffer);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  };
  framebuffer(bodies_);
  renderbuffer(bodies_.color, samples > 1 ? samples : 0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  renderbuffer(bodies_.depth, samples > 1 ? samples : 0, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  check("bodies'");
  framebuffer(picture_);
  renderbuffer(picture_.color, 0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  check("picture's");
  framebuffer(resolved_);
  gl_.GenTextures(1, &layer_texture_);
  gl_.BindTexture(GL_TEXTURE_2D, layer_texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, stage_.width, stage_.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, layer_texture_, 0);
  check("resolved");

  gl_.GenTextures(1, &shadow_texture_);
  gl_.BindTexture(GL_TEXTURE_2D, shadow_texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, shadow_map_edge, shadow_map_edge, 0, GL_DEPTH_COMPONENT,
                 GL_UNSIGNED_INT, nullptr);
  for (const auto& [key, value] : {std::pair{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
                                   {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
                                   {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE},
                                   {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE},
                                   {GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE},
                                   {GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL}}) {
    gl_.TexParameteri(GL_TEXTURE_2D, key, value);
  }
  gl_.GenFramebuffers(1, &shadow_framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_);
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_texture_, 0);
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  check("shadow");

  gl_.GenTextures(1, &occlusion_texture_);
  gl_.BindTexture(GL_TEXTURE_2D, occlusion_texture_);
  for (const auto& [key, value] : {std::pair{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
                                   {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
                                   {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE},
                                   {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE}}) {
    gl_.TexParameteri(GL_TEXTURE_2D, key, value);
  }
}

// Some software rasterisers accept a multisampled framebuffer and leave it blank, without an error; a triangle drawn
// into it shows whether this one does.
void Renderer::check_test_triangle() {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, bodies_.framebuffer);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  gl_.ClearColor(0, 0, 0, 1);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.UseProgram(backdrop_program_);
  gl_.Uniform3f(uniform(backdrop_program_, "background"), 1, 1, 1);
  gl_.Uniform1f(uniform(backdrop_program_, "exposure"), 1);
  gl_.BindVertexArray(empty_array_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, bodies_.framebuffer);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.framebuffer);
  gl_.BlitFramebuffer(0, 0, stage_.width, stage_.height, 0, 0, stage_.width, stage_.height, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.framebuffer);
  std::uint8_t pixel[4] = {0, 0, 0, 0};
  gl_.ReadPixels(stage_.width / 2, stage_.height / 2, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  check_gl(gl_, "drawing a test triangle");
  if (pixel[0] < 64) {
    throw RunError(
        fmt::format("{} ({}) draws blank frames with {} samples a pixel; try --set output.samples=1 or another --gl",
                    name_, context_.backend(), stage_.samples));
  }
}

void Renderer::make_label(std::size_t m) {
  const DrawMesh& mesh = stage_.meshes[m];
  gl_.DeleteTextures(1, &labels_[m].texture);  // deleting texture 0 is no error
  labels_[m] = {};
  if (stage_.font.empty() || mesh.label.empty()) return;
  const int pixels = std::max(9, static_cast<int>(std::lround(stage_.height / 32.0)));
  // The caption stands on the ground: a body that hangs in the air moves to a place below its start.
  const CaptionBitmap bitmap = draw_caption(stage_.font, mesh.label, pixels);
  Label label{0, bitmap.width, bitmap.height,
              Vec3(mesh.rest.center().x(), std::min(mesh.rest.lower.y(), 0.0), mesh.rest.upper.z())};
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.GenTextures(1, &label.texture);
  gl_.BindTexture(GL_TEXTURE_2D, label.texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, bitmap.width, bitmap.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                 bitmap.coverage.data());
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  labels_[m] = label;
}

void Renderer::upload(const DrawList& list) {
  for (const auto& [m, mesh] : list.renewed) {
    delete_mesh_buffers(gl_, meshes_[m]);
    meshes_[m] = make_mesh_buffers(gl_, mesh);
    stage_.meshes[m] = mesh;
  }
  for (const auto& [m, caption] : list.captions) {
    stage_.meshes[m].label = caption;
    make_label(m);
  }
  SUPPLE_CHECK(list.positions.size(), ==, meshes_.size());
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    MeshBuffers& buffers = meshes_[m];
    SUPPLE_CHECK(list.positions[m].size(), ==, buffers.vertices * 3);
    compute_normals(list.positions[m], stage_.meshes[m].triangles, buffers.normal_data);
    const auto bytes = static_cast<GLsizeiptr>(list.positions[m].size() * sizeof(float));
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffers.positions);
    gl_.BufferSubData(GL_ARRAY_BUFFER, 0, bytes, list.positions[m].data());
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffers.normals);
    gl_.BufferSubData(GL_ARRAY_BUFFER, 0, bytes, buffers.normal_data.data());
  }
  const std::vector<float>& open = occlusion_.compute(list.positions);
  gl_.BindTexture(GL_TEXTURE_2D, occlusion_texture_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, GroundOcclusion::cells, GroundOcclusion::cells, 0, GL_RED, GL_FLOAT,
                 open.data());
}

// The map is orthographic and covers the stage with room for motion; it is fixed for a whole film, so that shadows do
// not swim.
void Renderer::draw_shadow_map() {
  const Vec3 center = bounds_.center();
  const double radius = 0.5 * bounds_.diagonal() + 0.45 * largest_body_;
  Eigen::Matrix4f project = Eigen::Matrix4f::Identity();
  project(0, 0) = project(1, 1) = static_cast<float>(1 / radius);
  project(2, 2) = static_cast<float>(-1 / radius);  // covers depths from radius to 3 radius before the light's eye
  project(2, 3) = -2;
  light_matrix_ = project * look_at(center + 2 * radius * key_direction_, center);

  gl_.BindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_);
  gl_.Viewport(0, 0, shadow_map_edge, shadow_map_edge);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(2.0f, 4.0f);
  gl_.UseProgram(shadow_program_);
  gl_.UniformMatrix4fv(uniform(shadow_program_, "light_matrix"), 1, GL_FALSE, light_matrix_.data());
  for (std::size_t m = 0; m < meshes_.size(); ++m) draw_mesh(m);
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::draw_mesh(std::size_t m) {
  // Closed bodies hide their far sides, which need not be drawn; small triangles are what costs time.
  if (stage_.meshes[m].two_sided) {
    gl_.Disable(GL_CULL_FACE);
  } else {
    gl_.Enable(GL_CULL_FACE);
  }
  gl_.BindVertexArray(meshes_[m].array);
  gl_.DrawElements(GL_TRIANGLES, meshes_[m].count, GL_UNSIGNED_INT, nullptr);
}

void Renderer::set_lights(GLuint program, const Camera& camera) const {
  const auto vector = [&](const char* name, const Vec3& v) {
    gl_.Uniform3f(uniform(program, name), static_cast<float>(v.x()), static_cast<float>(v.y()),
                  static_cast<float>(v.z()));
  };
  vector("key_direction", key_direction_);
  vector("eye", camera.eye);
  vector("background", linear_of(stage_.background));
  vector("ground_color", linear_of(stage_.ground));
  gl_.Uniform1f(uniform(program, "exposure"), static_cast<float>(stage_.exposure));
  gl_.Uniform1f(uniform(program, "shadow_softness"),
                static_cast<float>(0.018 * largest_body_ / (0.5 * bounds_.diagonal() + 0.45 * largest_body_)));
  // The offset runs along the normal, so that a surface does not shade itself. It is what a squirrel's head of 0.7 m
  // needs, in proportion to the body's size.
  gl_.Uniform1f(uniform(program, "shadow_offset"), static_cast<float>(0.0058 * largest_body_));
  gl_.UniformMatrix4fv(uniform(program, "light_matrix"), 1, GL_FALSE, light_matrix_.data());
  gl_.Uniform1i(uniform(program, "shadow_map"), 0);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, shadow_texture_);
}

void Renderer::draw_bodies(const Camera& camera) {
  const double aspect = static_cast<double>(stage_.width) / stage_.height;
  const Eigen::Matrix4f view = view_matrix(camera, aspect, bounds_.center(), bounds_.diagonal() + largest_body_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, bodies_.framebuffer);
  gl_.Viewport(0, 0, stage_.width, stage_.height);
  gl_.ClearColor(0, 0, 0, 0);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_.UseProgram(body_program_);
  set_lights(body_program_, camera);
  gl_.UniformMatrix4fv(uniform(body_program_, "view_matrix"), 1, GL_FALSE, view.data());
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const DrawMesh& mesh = stage_.meshes[m];
    float colors[9 * 4] = {}, soft[8] = {};
    const auto put = [&](std::size_t slot, const Vec3& srgb, double gloss) {
      const Vec3 linear = linear_of(srgb);
      for (int k = 0; k < 3; ++k) colors[4 * slot + k] = static_cast<float>(linear[k]);
      colors[4 * slot + 3] = static_cast<float>(gloss);
    };
    put(0, mesh.color, mesh.gloss);
    for (std::size_t layer = 0; layer < mesh.layers.size() && layer < 8; ++layer) {
      put(layer + 1, mesh.layers[layer].color, mesh.layers[layer].gloss);
      soft[layer] = static_cast<float>(mesh.layers[layer].soft);
    }
    gl_.Uniform4fv(uniform(body_program_, "colors"), 9, colors);
    gl_.Uniform4fv(uniform(body_program_, "soft"), 2, soft);
    gl_.Uniform1i(uniform(body_program_, "layers"), static_cast<GLint>(mesh.layers.size()));
    gl_.Uniform1i(uniform(body_program_, "printed"), mesh.square.empty() ? 0 : mesh.printed == Printed::grid ? 1 : 2);
    draw_mesh(m);
  }

  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, bodies_.framebuffer);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.framebuffer);
  gl_.BlitFramebuffer(0, 0, stage_.width, stage_.height, 0, 0, stage_.width, stage_.height, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
}

// The ground has no edges of its own, so it is drawn with one sample a pixel, at a fraction of the cost, and the bodies
// are laid over it.
void Renderer::draw_ground(const Camera& camera) {
  const double aspect = static_cast<double>(stage_.width) / stage_.height;
  const Eigen::Matrix4f view = view_matrix(camera, aspect, bounds_.center(), bounds_.diagonal() + largest_body_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, picture_.framebuffer);
  gl_.BindVertexArray(empty_array_);
  gl_.UseProgram(backdrop_program_);
  set_lights(backdrop_program_, camera);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);

  gl_.UseProgram(ground_program_);
  set_lights(ground_program_, camera);
  gl_.UniformMatrix4fv(uniform(ground_program_, "view_matrix"), 1, GL_FALSE, view.data());
  const Vec3 center = bounds_.center();
  const double radius = 0.5 * bounds_.diagonal() + largest_body_;
  gl_.Uniform4f(uniform(ground_program_, "stage"), static_cast<float>(center.x()), static_cast<float>(center.z()),
                static_cast<float>(radius), 0);
  gl_.Uniform4f(uniform(ground_program_, "occlusion_area"), static_cast<float>(occlusion_.origin_x()),
                static_cast<float>(occlusion_.origin_z()), static_cast<float>(occlusion_.extent()), 0);
  gl_.Uniform1i(uniform(ground_program_, "occlusion_map"), 1);
  gl_.ActiveTexture(GL_TEXTURE1);
  gl_.BindTexture(GL_TEXTURE_2D, occlusion_texture_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindVertexArray(empty_array_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 6);
}

void Renderer::lay_bodies_over_ground() {
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // the resolved samples are already weighted by their coverage
  gl_.UseProgram(layer_program_);
  gl_.Uniform1i(uniform(layer_program_, "layer"), 0);
  gl_.BindTexture(GL_TEXTURE_2D, layer_texture_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Disable(GL_BLEND);
}

void Renderer::draw_labels(const Camera& camera) {
  const double aspect = static_cast<double>(stage_.width) / stage_.height;
  const Eigen::Matrix4f view = view_matrix(camera, aspect, bounds_.center(), bounds_.diagonal() + largest_body_);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.UseProgram(label_program_);
  gl_.BindVertexArray(empty_array_);
  gl_.Uniform1i(uniform(label_program_, "caption"), 0);
  for (const Label& label : labels_) {
    if (label.texture == 0) continue;
    const Eigen::Vector4f clip =
        view * Eigen::Vector4f(float(label.anchor.x()), float(label.anchor.y()), float(label.anchor.z()), 1);
    if (clip.w() <= 0) continue;
    // Positions are whole pixels, so that the letters stay sharp. The caption stands below the body, or at the bottom
    // edge when there is no room.
    const double x = std::round((clip.x() / clip.w() * 0.5 + 0.5) * stage_.width - 0.5 * label.width);
    const double below = (clip.y() / clip.w() * 0.5 + 0.5) * stage_.height - 0.035 * stage_.height;
    const double y = std::round(std::max(below - label.height, 0.01 * stage_.height));
    gl_.Uniform4f(uniform(label_program_, "area"), static_cast<float>(2 * x / stage_.width - 1),
                  static_cast<float>(2 * y / stage_.height - 1), static_cast<float>(2.0 * label.width / stage_.width),
                  static_cast<float>(2.0 * label.height / stage_.height));
    gl_.BindTexture(GL_TEXTURE_2D, label.texture);
    gl_.DrawArrays(GL_TRIANGLES, 0, 6);
  }
  gl_.Disable(GL_BLEND);
}

Image Renderer::draw(const DrawList& list) {
  upload(list);
  draw_shadow_map();
  draw_bodies(list.camera);
  draw_ground(list.camera);
  lay_bodies_over_ground();
  draw_labels(list.camera);

  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, picture_.framebuffer);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  std::vector<std::uint8_t> rows(std::size_t(stage_.width) * stage_.height * 4);
  gl_.ReadPixels(0, 0, stage_.width, stage_.height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  check_gl(gl_, "drawing a frame");
  Image image{stage_.width, stage_.height, {}};
  image.rgb.resize(std::size_t(stage_.width) * stage_.height * 3);
  for (int y = 0; y < stage_.height; ++y) {  // GL's rows begin at the bottom
    const std::uint8_t* from = rows.data() + std::size_t(stage_.height - 1 - y) * stage_.width * 4;
    std::uint8_t* to = image.rgb.data() + std::size_t(y) * stage_.width * 3;
    for (int x = 0; x < stage_.width; ++x) std::memcpy(to + 3 * x, from + 4 * x, 3);
  }
  return image;
}

}  // namespace supple
